// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "icp/cloud_problem.hpp"

namespace scanlock {

/// Quality of the result of an alignment, from its last state; members as in CloudAlignment.
struct CloudOutcome {
  double inlier_ratio = 0;
  Matrix6 covariance = Matrix6::Zero();
  std::uint32_t degenerate_axes = 0;
  bool degenerate = false;  ///< an axis is unconstrained, or less than 2 % of the points lie on the target
};

/// The outcome for `source` against `target` at the state that `problem` evaluated last, with the setup
/// `setup` and nu = `nu_min` (metres).
CloudOutcome outcome_of(const CentredCloud& source, const CloudTarget& target, const CloudProblem& problem,
                        const CloudProblem::Setup& setup, double nu_min);

}  // namespace scanlock
