// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of tools/demo with stand-ins that only print the output of the real programs.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "../contains.hpp"
#include "process.hpp"

using namespace scanlock::test;
namespace fs = std::filesystem;

namespace {

void write_program(const std::string& path, const std::string& text) {
  write_file(path, "#!/bin/bash\n" + text);
  fs::permissions(path, fs::perms::owner_all);
}

/// A tree with tools/demo, and stand-ins for the programs it runs; `replaced`: number of replaced scans that
/// the daemon reports.
void make_tree(const TemporaryFolder& folder, const std::string& replaced) {
  for (const char* name : {"tools", "build/bin", "path"}) fs::create_directories(folder / name);
  fs::copy_file(SCANLOCK_SOURCE_DIR "/tools/demo", folder / "tools/demo");
  write_program(folder / "path/ip", "true\n");
  write_program(folder / "path/lcm-logger", "echo SCANLOCK_STATUS >\"${@: -1}\"\nexec sleep 20\n");
  write_program(folder / "path/lcm-logplayer", "sleep 1\n");
  write_program(folder / "build/bin/scanlock-simulate", "true\n");
  write_program(folder / "build/bin/scanlockd",
                "trap 'echo \"scanlockd: ended: 10 scans received, " + replaced +
                    " replaced by newer ones\" >&2; kill $!; exit 0' TERM\n"
                    "echo 'scanlockd: TRACKING (was INITIALISING) at utime 1' >&2\n"
                    "sleep 20 & wait\n");
  write_program(folder / "build/bin/scanlock-evaluate",
                "echo 'while tracking 9 poses'\n"
                "while (($# > 0)); do\n"
                "  case $1 in --note) echo \"$2\" ;; --html | --picture) touch \"$2\" ;; esac\n"
                "  shift\n"
                "done\n");
}

Result run_demo(const TemporaryFolder& folder) {
  return run(folder, {"env", "PATH=" + (folder / "path") + ":" + std::getenv("PATH"), folder / "tools/demo",
                      "--inside", "--seconds", "1"});
}

}  // namespace

TEST_CASE("the demo prints the evaluation, the scan counts of the daemon and the path of the page") {
  const TemporaryFolder folder;
  make_tree(folder, "0");
  const Result result = run_demo(folder);
  CHECK_MESSAGE(result.code == 0, result.errors);
  CHECK(contains(result.output, "  while tracking 9 poses\n"));
  CHECK(contains(result.output, "  states: TRACKING (was INITIALISING)\n"));
  CHECK(contains(result.output, "  daemon: 10 scans received, 0 replaced"));
  CHECK(contains(result.output, "build/demo/index.html"));
  CHECK_FALSE(contains(result.output, "  note: "));
  for (const char* file : {"build/demo/index.html", "build/demo/drive.svg"}) CHECK(fs::exists(folder / file));
}

TEST_CASE("the demo prints a note if the machine was too slow for the sensor") {
  const TemporaryFolder folder;
  make_tree(folder, "3");
  const Result result = run_demo(folder);
  CHECK_MESSAGE(result.code == 0, result.errors);
  CHECK(contains(result.output, "  note: "));
}
