// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <scanlock/odometry_t.hpp>
#include <scanlock/recovery_t.hpp>
#include <scanlock/status_t.hpp>

#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;

namespace {

namespace fs = std::filesystem;

const char* name_of_state(int state) {
  static constexpr const char* kNames[] = {"INITIALISING", "TRACKING",  "DEGRADED",
                                           "RECOVERING",   "AMBIGUOUS", "LOST"};
  return kNames[state];
}

template <typename... Values>
std::string line(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string described(const scanlock::odometry_t& m) {
  static constexpr const char* kMethods[] = {"none", "icp", "global", "predicted"};
  const auto rounded = [](double value) { return value == 0 ? 0.0 : value; };  // without the sign of -0
  return line("%lld %s %s epoch %d axes %d pose %.3f %.3f %.3f turn %.3f %.3f %.3f %.3f\n",
              static_cast<long long>(m.utime), name_of_state(m.state), kMethods[m.method], m.epoch,
              m.degenerate_axes, rounded(m.pos[0]), rounded(m.pos[1]), rounded(m.pos[2]), m.quat[0],
              m.quat[1], m.quat[2], m.quat[3]);
}

std::string described(const scanlock::recovery_t& m) {
  return line("%lld recovery %s: ", static_cast<long long>(m.utime),
              m.accepted ? "accepted" : "not accepted") +
         m.reason + "\n";
}

std::string described(const scanlock::status_t& m) {
  std::string text;
  const std::pair<const char*, std::int64_t> counters[] = {
      {"scans_received", m.scans_received},
      {"sectors_received", m.sectors_received},
      {"sectors_discarded", m.sectors_discarded},
      {"scans_used", m.scans_used},
      {"scans_incomplete", m.scans_incomplete},
      {"rejected_truncated", m.rejected_truncated},
      {"rejected_unknown_type", m.rejected_unknown_type},
      {"rejected_bad_size", m.rejected_bad_size},
      {"rejected_bad_field", m.rejected_bad_field},
      {"rejected_empty", m.rejected_empty},
      {"rejected_duplicate_time", m.rejected_duplicate_time},
      {"rejected_backward_time", m.rejected_backward_time},
      {"rejected_clock", m.rejected_clock},
      {"clock_steps", m.clock_steps},
      {"scans_without_time", m.scans_without_time},
      {"commands", m.commands},
      {"commands_rejected", m.commands_rejected},
      {"recoveries", m.recoveries},
      {"recovery_failures", m.recovery_failures}};
  for (const auto& [name, value] : counters)
    if (value != 0) text += line("%s %lld\n", name, static_cast<long long>(value));
  if (!m.last_error.empty()) text += "last_error " + m.last_error + "\n";
  return text;
}

/// The output of scanlock-odometry for a log: one line per scan, the searches, and the counters at the end.
std::string outcome_of(const fs::path& log) {
  const TemporaryFolder folder;
  std::vector<std::string> command = {"scanlock-odometry", log.string(), "--output", folder / "out.lcmlog"};
  const fs::path config = fs::path(log).replace_extension(".toml");
  if (fs::exists(config)) command.insert(command.end(), {"-c", config.string()});
  const Result result = run(folder, command);
  CAPTURE(result.errors);
  CHECK(result.code == 0);
  std::string text, last_status;
  for (const Event& event : read_log(folder / "out.lcmlog")) {
    if (event.channel == "SCANLOCK_ODOMETRY") text += described(decoded<scanlock::odometry_t>(event));
    if (event.channel == "SCANLOCK_RECOVERY") text += described(decoded<scanlock::recovery_t>(event));
    if (event.channel == "SCANLOCK_STATUS") last_status = described(decoded<scanlock::status_t>(event));
  }
  return text + last_status;
}

}  // namespace

TEST_CASE("each log of the collection leads to what it led to") {
  const bool bless = std::getenv("SCANLOCK_BLESS") != nullptr;
  std::vector<fs::path> logs;
  for (const auto& entry : fs::directory_iterator(fs::path(SCANLOCK_SOURCE_DIR) / "test/logs"))
    if (entry.path().extension() == ".lcmlog") logs.push_back(entry.path());
  std::sort(logs.begin(), logs.end());
  CHECK(logs.size() >= 24);
  for (const fs::path& log : logs) {
    CAPTURE(log.filename().string());
    const fs::path expected = fs::path(log).replace_extension(".expected");
    const std::string outcome = outcome_of(log);
    if (bless) write_file(expected.string(), outcome);
    CHECK(read_file(expected.string()) == outcome);
  }
}
