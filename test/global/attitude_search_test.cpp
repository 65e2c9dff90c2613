// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/attitude_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "../trials.hpp"
#include "geometry/rigid.hpp"
#include "judge.hpp"
#include "match_samples.hpp"

namespace scanlock {
namespace {

using Eigen::Vector3d;

constexpr int kInliers = 30, kRunnerUp = 26, kOutliers = 300;

/// Matches with a large consensus in one of several attitudes, a runner-up consensus in another attitude, and
/// random outliers.
struct Slopes {
  explicit Slopes(unsigned seed) : sample(seed) {
    for (int k = 0; k < 6; ++k)
      ups.push_back(Vector3d(sample.uniform(-0.3, 0.3), sample.uniform(-0.3, 0.3), 1).normalized());
    plant(0, kInliers + kOutliers, kInliers);
    plant(3, kRunnerUp, kRunnerUp);
  }
  void plant(std::size_t attitude, int count, int inliers) {
    const Pose truth = sample.pose(10);
    for (Match m : sample.matches(count, inliers, truth, 20, 0.05)) {
      m.q = level_rotation(ups[attitude]).transpose() * m.q;
      matches.push_back(m);
    }
  }

  MatchSampler sample;
  std::vector<Vector3d> ups;
  Matches matches;
};

/// The largest consensus over all attitudes, by a complete search in each.
int most_of_all(const Slopes& slopes) {
  int most = 0;
  for (const Vector3d& up : slopes.ups) {
    Matches turned = slopes.matches;
    for (Match& m : turned) m.q = level_rotation(up) * m.q;
    most = std::max(most, register_matches(turned).consensus);
  }
  return most;
}

}  // namespace

TEST_CASE("of several attitudes the one with the largest consensus is found, whatever their order") {
  for (int seed = 1; seed <= trials(12); ++seed) {
    CAPTURE(seed);
    Slopes slopes(static_cast<unsigned>(seed));
    const int most = most_of_all(slopes);
    REQUIRE(most >= kInliers);
    for (int order = 0; order < 3; ++order) {
      CAPTURE(order);
      const MatchRegistration found = search_attitudes(slopes.matches, {}, slopes.ups, Vector3d::Zero());
      CHECK(found.consensus == most);
      CHECK(found.upper_bound == most);
      CHECK(found.certified);
      CHECK(found.matches == slopes.matches.size());
      CHECK(counted_consensus(slopes.matches, 0.1, found.target_from_source) == most);
      CHECK(found.runner_up_consensus >= kRunnerUp);
      CHECK(found.runner_up_bound >= found.runner_up_consensus);
      CHECK(counted_consensus(slopes.matches, 0.1, found.runner_up) == found.runner_up_consensus);
      std::rotate(slopes.ups.begin(), slopes.ups.begin() + 2, slopes.ups.end());
    }
  }
}

TEST_CASE("the runner-up needs no second search") {
  const Slopes slopes(3);
  const Vector3d up = slopes.ups.front();
  Matches turned = slopes.matches;
  for (Match& m : turned) m.q = level_rotation(up) * m.q;
  MatchRegistrationOptions alone;
  alone.runner_up = false;
  alone.at_least = kFewestMatches;
  const MatchRegistration found = search_attitudes(slopes.matches, {}, {up}, Vector3d::Zero());
  CHECK(found.runner_up_consensus > 0);
  CHECK(found.nodes == register_matches(turned, alone).nodes);
}

TEST_CASE("the work limit holds for all attitudes together, and unsearched attitudes are not ruled out") {
  const Slopes slopes(3);
  MatchRegistrationOptions options;
  std::vector<Vector3d> ups;
  for (int k = 0; k < 60; ++k) ups.push_back(slopes.ups[static_cast<std::size_t>(k) % slopes.ups.size()]);
  const MatchRegistration all = search_attitudes(slopes.matches, options, ups, Vector3d::Zero());
  REQUIRE(all.certified);
  options.max_work = all.work / 10;
  const MatchRegistration some = search_attitudes(slopes.matches, options, ups, Vector3d::Zero());
  CHECK(some.work < all.work / 8);
  CHECK_FALSE(some.certified);
  CHECK(some.upper_bound >= all.consensus);
}

TEST_CASE("the mean direction, also of no directions and of opposite ones") {
  const Vector3d z = Vector3d::UnitZ(), aside = Vector3d(0.1, 0, 1).normalized();
  CHECK(middle_of({}) == z);
  CHECK(middle_of({aside}) == aside);
  CHECK((middle_of({Vector3d(0.2, 0, 1), Vector3d(-0.2, 0, 1)}) - z).norm() < 1e-12);
  CHECK(middle_of({aside, -aside}) == aside);
}

TEST_CASE("without enough matches at any attitude the consensus is 0, and its bound is below the minimum") {
  MatchSampler sample(5);
  const Matches matches = sample.matches(200, 0, Pose::Identity(), 20, 0);
  const MatchRegistration found =
      search_attitudes(matches, {}, {Vector3d(0.1, 0, 1).normalized(), Vector3d::UnitZ()}, Vector3d::Zero());
  CHECK(found.consensus == 0);
  CHECK(found.upper_bound == kFewestMatches - 1);
  CHECK(found.matches == 200);
}

}  // namespace scanlock
