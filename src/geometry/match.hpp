// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

namespace scanlock {

/// A candidate correspondence: source point p and target point q, metres.
struct Match {
  Eigen::Vector3d p, q;
};
using Matches = std::vector<Match>;

}  // namespace scanlock
