// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../contains.hpp"
#include "process.hpp"

using namespace scanlock::test;

namespace {

/// tools/kidnaps over a drive through a tunnel, which is too short for a recovery.
std::vector<std::string> table_command(const std::vector<std::string>& more) {
  std::vector<std::string> command = {SCANLOCK_SOURCE_DIR "/tools/kidnaps",
                                      "--bin",
                                      SCANLOCK_BIN_DIR,
                                      "--worlds",
                                      "tunnel",
                                      "--seeds",
                                      "1",
                                      "--seconds",
                                      "5",
                                      "--event",
                                      "kidnap@4.5"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

}  // namespace

TEST_CASE("the table of kidnaps fails where fewer drives recovered than are required" *
          doctest::test_suite("long drives")) {
  const TemporaryFolder folder;
  const Result result = run(folder, table_command({"--require", "tunnel:1/1"}));
  CHECK(result.code == 1);
  CHECK(contains(result.errors, "kidnaps: tunnel: 0 of 1 drives recovered, 1 required"));
  CHECK(run(folder, table_command({"--require", "tunnel:0/1"})).code == 0);
  CHECK(run(folder, table_command({"--require", "tunnel:1/2"})).code == 2);
  CHECK(run(folder, table_command({"--require", "urban:1/1"})).code == 2);
}

TEST_CASE("the table of kidnaps replaces the logs that it kept earlier only with --force" *
          doctest::test_suite("long drives")) {
  const TemporaryFolder folder;
  const std::string kept = folder / "tunnel-1", note = kept + "/scans.lcmlog";
  std::filesystem::create_directory(kept);
  write_file(note, "of an earlier run");
  const Result refused = run(folder, table_command({"--keep", folder / ""}));
  CHECK(refused.code == 1);
  CHECK(contains(refused.errors, kept + ": is there already; --force overwrites it"));
  CHECK(read_file(note) == "of an earlier run");
  CHECK(run(folder, table_command({"--keep", folder / "", "--force"})).code == 0);
  CHECK(read_file(note) != "of an earlier run");

  const auto whole = std::filesystem::file_size(note);
  CHECK(run(folder, table_command({"--keep", folder / "", "--force", "--gap", "0.3"})).code == 0);
  CHECK(std::filesystem::file_size(note) < whole);
  CHECK(run(folder, table_command({"--gap", "-1"})).code == 2);
}
