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

/// What a report is about. The trajectories stand as they were read; the pairs come from them.
struct Comparison {
  std::string estimate_name, reference_name;
  Trajectory estimate, reference;
  PosePairs pairs;
  Evaluation evaluation;
  KidnapReport kidnaps;
  std::vector<StampedState> states;  ///< of the estimate, in the order of time; empty: not known
  std::optional<Nees> nees;          ///< of the same states; nothing: not known
  SplitErrors split;                 ///< of the same pairs, kidnaps and states
  Rows notes;                        ///< of the caller: further rows of the table
};

/// The result as rows of a table: what, and how much with its unit ("-" where the way is too short).
Rows result_rows(const Comparison& comparison);

/// A picture of 1000 x 1020 pixels: both trajectories from above, height and error over the way. Thousands of
/// poses are thinned to what can be seen. Where the reference was kidnapped, the jump is marked, and the
/// estimate is laid over what was before it; where the states are known, poses that do not claim to track are
/// dashed. Where some poses do not count as tracked, the error is that of the others.
std::string trajectory_svg(const Comparison& comparison);

/// One self-contained page with the picture beside the table (below it, where the window is narrow).
std::string trajectory_html(const Comparison& comparison);

}  // namespace scanlock
