// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// tools/demo, with programs that only say what the real ones would.
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

/// A tree with tools/demo, and stand-ins for the programs it runs; `replaced` scans were too many.
void make_tree(const TemporaryFolder& folder, const std::string& replaced) {
  for (const char* name : {"tools", "build/bin", "path"}) fs::create_directories(folder / name);
  fs::copy_file(SCANLOCK_SOURCE_DIR "/tools/demo", folder / "tools/demo");
  write_program(folder / "path/ip", "true\n");
  write_program(folder / "path/lcm-logger", "echo SCANLOCK_STATUS >\"${@: -1}\"\nexec sleep 20\n");
  write_program(folder / "path/lcm-logplayer", "sleep 1\n");
  write_program(folder / "build/bin/scanlock-simulate", "true\n");
  write_program(folder / "build/bin/scanlockd",
                "trap 'echo \"scanlockd: ended: 10 scans received, " + replaced +
                    " replaced by fresher ones\" >&2; kill $!; exit 0' TERM\n"
                    "echo 'scanlockd: TRACKING (was INITIALISING) at utime 1' >&2\n"
                    "sleep 20 & wait\n");
  write_program(folder / "build/bin/scanlock-evaluate",
                "echo '<svg xmlns=\"http://www.w3.org/2000/svg\"><g/></svg>' >\"$4\"\n"
                "printf '%-20s %s\\n' 'while tracking' '9 poses' '  ATE rmse' 'a < b & c'\n");
}

Result run_demo(const TemporaryFolder& folder) {
  return run(folder, {"env", "PATH=" + (folder / "path") + ":" + std::getenv("PATH"), folder / "tools/demo",
                      "--inside", "--seconds", "1"});
}

}  // namespace

TEST_CASE(
    "the demo writes one page that needs nothing else, with the numbers that it prints, and says where") {
  const TemporaryFolder folder;
  make_tree(folder, "0");
  const Result result = run_demo(folder);
  CHECK_MESSAGE(result.code == 0, result.errors);
  CHECK(contains(result.output, "  while tracking       9 poses\n"));
  CHECK(contains(result.output, "  states               TRACKING (was INITIALISING)\n"));
  CHECK(contains(result.output, "build/demo/index.html"));
  CHECK_FALSE(contains(result.output, "  note "));
  const std::string page = read_file(folder / "build/demo/index.html");
  CHECK(page.rfind("<!DOCTYPE html>", 0) == 0);
  CHECK(contains(page, "<svg xmlns=\"http://www.w3.org/2000/svg\"><g/></svg>"));
  CHECK(contains(page, "<tr><td>while tracking      </td><td>9 poses</td></tr>"));
  CHECK(contains(page, "<tr><td>  ATE rmse          </td><td>a &lt; b &amp; c</td></tr>"));
  CHECK(contains(page, "<tr><td>daemon              </td><td>10 scans received, 0 replaced"));
  for (const char* outside : {"src=", "href=", "url(", "@import", "<script"})
    CHECK_FALSE(contains(page, outside));
}

TEST_CASE("the demo says where the machine was too slow for the sensor") {
  const TemporaryFolder folder;
  make_tree(folder, "3");
  const Result result = run_demo(folder);
  CHECK_MESSAGE(result.code == 0, result.errors);
  CHECK(contains(result.output, "  note "));
  CHECK(contains(read_file(folder / "build/demo/index.html"), "<tr><td>note "));
}
