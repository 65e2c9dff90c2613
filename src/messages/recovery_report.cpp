// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/reports.hpp"

namespace scanlock {

RecoveryReport report_of(const Recovery& recovery, std::int64_t utime, std::int64_t seq, bool times) {
  const RecoveryAnswer& search = recovery.search;
  RecoveryReport report;
  report.utime = utime;
  report.seq = seq;
  report.epoch = static_cast<std::int32_t>(recovery.epoch);
  report.map_from_body = recovery.map_from_body;
  report.correction = recovery.map_from_predicted;
  report.energy_before = recovery.energy_before;
  report.energy_after = recovery.energy_after;
  report.matches = search.matches;
  report.matches_kept = search.matches_kept;
  report.consensus = search.consensus;
  report.upper_bound = search.upper_bound;
  report.runner_up_consensus = search.runner_up_consensus;
  report.certified = search.certified;
  report.accepted = recovery.accepted;
  report.reason = recovery.reason;
  report.nodes = search.nodes;
  if (times) {
    report.search_ms = static_cast<float>(search.search_ms);
    report.total_ms = static_cast<float>(search.total_ms);
  }
  return report;
}

}  // namespace scanlock
