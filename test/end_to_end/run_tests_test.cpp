// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the counts of tools/run_tests: a test case that did not pass must never count as passed.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "process.hpp"

using namespace scanlock::test;
namespace fs = std::filesystem;

namespace {

/// Runs tools/run_tests over a folder with one test program, a script that reports `count` test cases and
/// then executes `body`.
struct RunnerOutcome {
  int code = -1;
  std::string results;
};
RunnerOutcome outcome_of(int count, const std::string& body) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "test");
  write_file(folder / "test/test_io",
             "#!/bin/bash\n"
             "record() { echo \"$*\" >>\"$SCANLOCK_TEST_RECORD\"; }\n"
             "if [[ $* == *--count* ]]; then\n"
             "  echo '[doctest] unskipped test cases passing the current filters: " +
                 std::to_string(count) + "'\n  exit 0\nfi\n" + body);
  fs::permissions(folder / "test/test_io", fs::perms::owner_all);
  const Result result = run(folder, {SCANLOCK_SOURCE_DIR "/tools/run_tests", folder / "", "--rooms", "io",
                                     "--results", folder / "results"});
  return {result.code, read_file(folder / "results")};
}

}  // namespace

TEST_CASE("the test runner reports passed, failed and skipped test cases") {
  const RunnerOutcome good = outcome_of(2,
                                        "record begun a; record passed 0.1 a\n"
                                        "record begun b; record skipped 0.1 b: no network\n");
  CHECK(good.code == 0);
  CHECK(good.results == "passed\nskipped test_io: b: no network\n");
  const RunnerOutcome bad = outcome_of(2,
                                       "record begun a; record failed 0.1 a\n"
                                       "record begun b; record passed 0.1 b\nexit 1\n");
  CHECK(bad.code == 1);
  CHECK(bad.results == "passed\nfailed test_io: a\n");
}

TEST_CASE("the test runner counts a crash, the test cases after it and a leak as failed") {
  const RunnerOutcome crashed = outcome_of(3,
                                           "record begun a; record passed 0.1 a\n"
                                           "record begun b\nexit 134\n");
  CHECK(crashed.code == 1);
  CHECK(crashed.results ==
        "passed\nfailed test_io: b (ended with 134)\nfailed test_io: a test case behind it did not run\n");
  const RunnerOutcome leaked = outcome_of(1, "record begun a; record passed 0.1 a\nexit 23\n");
  CHECK(leaked.code == 1);
  CHECK(leaked.results == "failed test_io: after its last test case (ended with 23)\n");
}

TEST_CASE("the test runner fails where no test case ran") {
  const RunnerOutcome silent = outcome_of(1, "");
  CHECK(silent.code == 1);
  CHECK(silent.results == "failed test_io: a test case behind it did not run\n");
  const RunnerOutcome empty = outcome_of(0, "");
  CHECK(empty.code == 1);
  CHECK(empty.results == "failed test_io: 0 of 0 test cases ran\n");
}
