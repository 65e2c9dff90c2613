// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/match_ransac.hpp"

#include <doctest/doctest.h>

#include "global/max_consensus.hpp"
#include "match_samples.hpp"

namespace scanlock {
namespace {

TEST_CASE("The baseline finds a pose of half the matches, and never more than the certified optimum") {
  MatchSampler sample(1);
  const Pose truth = sample.pose(5);
  const Matches matches = sample.matches(200, 100, truth, 10, 0.05);
  const MatchRansac found = ransac_matches(matches, {});
  CHECK(found.consensus > 50);
  CHECK(found.consensus <= register_matches(matches).consensus);
  CHECK(found.samples < 1000);
  CHECK((found.target_from_source.translation() - truth.translation()).norm() < 0.5);
  CHECK(ransac_matches({}, {}).consensus == 0);
}

}  // namespace
}  // namespace scanlock
