// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "geometry/match.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

struct MatchRansacOptions {
  double epsilon = 0.1;      ///< metres
  double confidence = 0.99;  ///< probability that a sample of inliers was drawn, if the best pose is right
  std::size_t most_samples = 1'000'000;
  unsigned seed = 1;
};

struct MatchRansac {
  Pose target_from_source = Pose::Identity();
  int consensus = 0;
  std::size_t samples = 0;
};

/// The paper's baseline, only for the benchmark: RANSAC over levelled motions (up is z) with samples of two
/// matches. No certificate; deterministic for a given seed.
MatchRansac ransac_matches(const Matches& matches, const MatchRansacOptions& options);

}  // namespace scanlock
