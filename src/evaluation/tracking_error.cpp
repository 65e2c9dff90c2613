// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/tracking_error.hpp"

#include <limits>

namespace scanlock {
namespace {

/// The pairs between a kidnap and the recovery from it; marks them as not tracked.
PosePairs away_pairs(const PosePairs& pairs, const std::vector<Kidnap>& kidnaps, std::size_t index,
                     std::vector<char>& tracked) {
  const Kidnap& kidnap = kidnaps[index];
  double end_s = std::numeric_limits<double>::infinity();
  if (kidnap.recovery_s)
    end_s = kidnap.time_s + *kidnap.recovery_s;
  else if (index + 1 < kidnaps.size())
    end_s = kidnaps[index + 1].time_s;
  PosePairs away;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].time_s < kidnap.time_s - kSameTime || pairs[i].time_s >= end_s - kSameTime) continue;
    away.push_back(pairs[i]);
    tracked[i] = 0;
  }
  return away;
}

/// Runs of consecutive tracked pairs.
std::vector<PosePairs> tracked_runs(const PosePairs& pairs, const std::vector<char>& tracked) {
  std::vector<PosePairs> runs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (tracked[i] == 0) continue;
    if (i == 0 || tracked[i - 1] == 0) runs.emplace_back();
    runs.back().push_back(pairs[i]);
  }
  return runs;
}

std::optional<TrackingError> tracking_error(const PosePairs& pairs, const std::vector<char>& tracked,
                                            Overlay kind) {
  const std::vector<PosePairs> runs = tracked_runs(pairs, tracked);
  PosePairs all;
  for (const PosePairs& run : runs) all.insert(all.end(), run.begin(), run.end());
  if (all.size() < poses_needed(kind)) return std::nullopt;
  TrackingError error;
  error.poses = all.size();
  error.reference_from_estimate = overlay(all, kind);
  error.ate_m = absolute_error(position_errors(all, error.reference_from_estimate));
  for (std::size_t i = 0; i < kRelativeLengths.size(); ++i)
    error.rpe[i] = relative_error(runs, kRelativeLengths[i]);
  return error;
}

}  // namespace

SplitErrors split_errors(const PosePairs& pairs, const std::vector<StampedState>& states,
                         const KidnapReport& report, Overlay kind) {
  SplitErrors split;
  for (const PosePair& pair : pairs) split.tracked.push_back(claims_to_track(states, pair.time_s) ? 1 : 0);
  for (std::size_t i = 0; i < report.kidnaps.size(); ++i) {
    const PosePairs away = away_pairs(pairs, report.kidnaps, i, split.tracked);
    AwayError error;
    error.poses = away.size();
    if (!away.empty()) error.ate_m = absolute_error(position_errors(away, report.reference_from_estimate));
    split.away.push_back(error);
  }
  split.tracking = tracking_error(pairs, split.tracked, kind);
  return split;
}

}  // namespace scanlock
