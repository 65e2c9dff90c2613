// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/kidnaps.hpp"
#include "evaluation/metrics.hpp"
#include "evaluation/nees.hpp"
#include "evaluation/tracking_error.hpp"

namespace scanlock {

using Rows = std::vector<std::pair<std::string, std::string>>;

/// The input of a report. The trajectories are as read from their files; `pairs` was made from them.
struct Comparison {
  std::string estimate_name, reference_name;
  Trajectory estimate, reference;
  PosePairs pairs;
  Evaluation evaluation;
  KidnapReport kidnaps;
  std::vector<StampedState> states;  ///< of the estimate, in the order of time; empty when not known
  std::optional<Nees> nees;          ///< of the same states; nothing when not known
  SplitErrors split;                 ///< of the same pairs, kidnaps and states
  Rows notes;                        ///< further rows of the table, from the caller
};

/// The results as rows of a table: name and value with unit ("-" when the path is too short).
Rows result_rows(const Comparison& comparison);

/// A picture of 1000 x 1020 pixels: both trajectories from above, and height and error over the path length.
/// Trajectories of thousands of poses are thinned to visible detail. Kidnaps of the reference are marked. If
/// the states are known, poses that are neither TRACKING nor DEGRADED are dashed. The estimate is aligned by
/// its tracked poses, whose error is shown; if all poses are tracked, by those before the first kidnap.
std::string trajectory_svg(const Comparison& comparison);

/// A self-contained page with the picture beside the table (above it in a narrow window).
std::string trajectory_html(const Comparison& comparison);

}  // namespace scanlock
