// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the solver against the printed algorithms of the paper (test/reference), on some dozens of
// matches.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "../reference/match_pruning.hpp"
#include "../trials.hpp"
#include "global/bounds/angle_stabbing.hpp"
#include "global/max_consensus.hpp"
#include "match_samples.hpp"

namespace scanlock {
namespace {

constexpr int kMostCubes = 200'000;

bool contains(const Matches& set, const Match& match) {
  return std::any_of(set.begin(), set.end(),
                     [&](const Match& other) { return other.p == match.p && other.q == match.q; });
}

TEST_CASE("Angle intervals are those of the printed algorithm 4") {
  MatchSampler sample(1);
  int counts[3] = {};
  for (int i = 0; i < 5000; ++i) {
    Eigen::Vector3d p = sample.point(1), q = sample.point(1);
    p.z() = q.z() = 0;  // the solver uses the horizontal threshold
    const double e = sample.uniform(0, 1.5), p_azimuth = std::atan2(p.y(), p.x()),
                 q_azimuth = std::atan2(q.y(), q.x());
    AngleInterval interval;
    const AngleReach reach = reach_of(p.norm(), p_azimuth, q.norm(), q_azimuth, e, interval);
    const auto printed = reference::angle_interval(p, q, e);
    ++counts[static_cast<int>(reach)];
    if (!printed) {
      CHECK(reach == AngleReach::kNever);
    } else if (printed->second - printed->first >= 2 * kPi) {
      CHECK(reach == AngleReach::kAlways);
    } else {
      REQUIRE(reach == AngleReach::kInterval);
      CHECK(interval.width == doctest::Approx(printed->second - printed->first).epsilon(1e-6));
      CHECK(std::abs(std::remainder(interval.start - printed->first, 2 * kPi)) < 1e-6);
    }
  }
  for (const int count : counts) CHECK(count > 100);
}

TEST_CASE("Stabbing is as deep as the printed algorithm 5") {
  MatchSampler sample(2);
  for (int i = 0; i < 300; ++i) {
    AngleStabber stabber;
    std::vector<reference::Interval> printed;
    for (int k = sample.integer(1, 30); k > 0; --k) {
      // Multiples of a 64th of a turn, so that ends of intervals coincide.
      const double unit = i % 2 == 0 ? 1 : 2 * kPi / 64;
      const double start = i % 2 == 0 ? sample.uniform(0, 6.28) : unit * sample.integer(0, 63);
      const double width = i % 2 == 0 ? sample.uniform(0, 3) : unit * sample.integer(0, 20);
      stabber.add({start, width});
      for (const auto& part : reference::within_a_turn({start, start + width})) printed.push_back(part);
    }
    double theta = 0;
    CHECK(stabber.stab(theta) == reference::max_stabbing(printed).depth);
  }
}

/// Many correct matches, or few or none among many that nearly fit by chance, where the result depends on the
/// bounds.
Matches matches_of(MatchSampler& sample, int i, double epsilon) {
  const int count = sample.integer(8, 32),
            inliers = i % 2 == 0 ? sample.integer(6, 12) : sample.integer(0, 4);
  const double half_side = i % 2 == 0 ? 2 : sample.uniform(4, 8) * epsilon;
  return sample.matches(std::max(count, inliers), inliers, sample.pose(1), half_side,
                        sample.uniform(0.2, 1.2) * epsilon, i % 3 == 0);
}

TEST_CASE("The consensus is that of the printed algorithms 1 and 2") {
  for (int i = 0; i < trials(300); ++i) {
    CAPTURE(i);
    MatchSampler sample(100 + static_cast<unsigned>(i));
    MatchRegistrationOptions options;
    options.epsilon = sample.uniform(0.05, 0.2);
    const Matches matches = matches_of(sample, i, options.epsilon);
    const reference::Consensus expected = reference::max_consensus(matches, options.epsilon, kMostCubes);
    const reference::Pruned pruned = reference::match_pruning(matches, options.epsilon);
    CHECK(reference::aligned(matches, expected.theta, expected.t, options.epsilon * (1 + 1e-9)) ==
          expected.count);
    if (i % 4 == 0)
      CHECK(reference::translation_search(matches, options.epsilon, kMostCubes).count == expected.count);
    CHECK(pruned.lower_bound <= expected.count);
    for (const bool prune : {true, false}) {
      options.prune = prune;
      const MatchRegistration found = register_matches(matches, options);
      CHECK(found.consensus == expected.count);
      CHECK(found.certified);
      // Lemmas 2 and 3: the printed pruning keeps all inliers of the pose, and their bounds are at least its
      // consensus.
      for (const std::uint32_t k : found.inliers) {
        CHECK(contains(pruned.matches, matches[k]));
        CHECK(pruned.bounds[k] >= found.consensus);
      }
    }
  }
}

}  // namespace
}  // namespace scanlock
