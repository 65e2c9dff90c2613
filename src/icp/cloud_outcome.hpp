// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "icp/cloud_problem.hpp"

namespace scanlock {

/// What the last state of an alignment says about its result; each as in CloudAlignment.
struct CloudOutcome {
  double inlier_ratio = 0;
  Matrix6 covariance = Matrix6::Zero();
  std::uint32_t degenerate_axes = 0;
  bool degenerate = false;  ///< a motion is open, or nearly no point lies on the target
};

/// Of `source` against `target` at the state that `problem`, of the method `setup`, evaluated last; its nu
/// was `nu_min`.
CloudOutcome outcome_of(const CentredCloud& source, const CloudTarget& target, const CloudProblem& problem,
                        const CloudProblem::Setup& setup, double nu_min);

}  // namespace scanlock
