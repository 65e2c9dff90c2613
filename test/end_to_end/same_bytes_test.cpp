// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "process.hpp"

using namespace scanlock::test;
using std::chrono::seconds;

namespace {

/// glibc has variants of sin, exp and similar functions for processors with FMA and AVX2, which round
/// differently. These environment variables disable them. (Up to glibc 2.32 the names end with "_Usable".)
const std::string kOlderProcessor =
    "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable,-FMA4_Usable";
const std::string kThisProcessor = "GLIBC_TUNABLES=";

std::string output_of(const TemporaryFolder& folder, const std::vector<std::string>& command) {
  Process process(folder, command);
  const auto code = process.wait(seconds(120));
  INFO(process.errors());
  REQUIRE(code == 0);
  return process.output();
}

}  // namespace

TEST_CASE("a replay writes the same bytes on another processor, through a kidnap and the search after it" *
          doctest::test_suite("long drives")) {
  const TemporaryFolder folder;
  const auto digits = [&](const std::string& processor) {
    return output_of(folder, {"env", processor, "awk",
                              "BEGIN { for (i = 1; i < 3000; ++i) printf \"%.17g %.17g \", sin(0.37 * i), "
                              "exp(-0.01 * i) }"});
  };
  // Otherwise it is another C library or an older processor, and the following checks prove little.
  WARN(digits(kThisProcessor) != digits(kOlderProcessor));

  output_of(folder, {"scanlock-simulate", "--world", "urban", "--lidar", "vlp16", "--seconds", "8", "--seed",
                     "5", "--event", "kidnap@4", folder / "drive.lcmlog"});
  const auto replay = [&](const std::string& processor, const std::string& name) {
    return output_of(folder, {"env", processor, SCANLOCK_BIN_DIR "/scanlock-odometry",
                              folder / "drive.lcmlog", "--output", folder / (name + ".lcmlog"), "--poses",
                              folder / (name + ".tum"), "--map", folder / (name + ".ply"), "--json"});
  };
  const std::string said = replay(kThisProcessor, "this");
  CHECK(said.find("\"recoveries\":1") != std::string::npos);
  replay(kOlderProcessor, "older");
  for (const std::string extension : {".lcmlog", ".tum", ".ply"}) {
    CAPTURE(extension);
    const std::string bytes = read_file(folder / ("this" + extension));
    CHECK(bytes.size() > 1000);
    // In parentheses, so that a failure does not print them.
    CHECK((bytes == read_file(folder / ("older" + extension))));
  }
}
