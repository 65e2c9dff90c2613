// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the solver against judged_consensus(), with and without pruning.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>

#include "../trials.hpp"
#include "global/max_consensus.hpp"
#include "judge.hpp"
#include "match_samples.hpp"

namespace scanlock {
namespace {

/// The number of cases, multiplied by SCANLOCK_JUDGE_CASES for a long run.
int cases(int n) {
  const char* factor = std::getenv("SCANLOCK_JUDGE_CASES");
  return factor ? trials(n) * std::atoi(factor) : trials(n);
}

void check_against_judge(const Matches& matches, double epsilon) {
  const int expected = judged_consensus(matches, epsilon);
  for (const bool prune : {true, false}) {
    MatchRegistrationOptions options;
    options.epsilon = epsilon;
    options.prune = prune;
    const MatchRegistration found = register_matches(matches, options);
    CAPTURE(prune);
    REQUIRE(found.consensus == expected);
    REQUIRE(found.upper_bound == expected);
    REQUIRE(found.certified);
    REQUIRE(static_cast<int>(found.inliers.size()) == expected);
    REQUIRE(counted_consensus(matches, epsilon, found.target_from_source) >= expected);
    REQUIRE(found.matches_after_pruning >= found.inliers.size());
  }
}

TEST_CASE("Random matches with up to 95 percent outliers") {
  for (int i = 0; i < cases(1000); ++i) {
    CAPTURE(i);
    MatchSampler sample(static_cast<unsigned>(i));
    const int count = sample.integer(1, i % 10 == 0 ? 60 : 24);  // judged_consensus() takes cubic time
    const int inliers = static_cast<int>(std::ceil(count * sample.uniform(0.05, 1.0)));
    const double half_side = sample.uniform(0.5, 3), epsilon = sample.uniform(0.05, 0.3);
    check_against_judge(
        sample.matches(count, inliers, sample.pose(1), half_side, sample.uniform(0, 1.3) * epsilon), epsilon);
  }
}

TEST_CASE("Outliers only") {
  for (int i = 0; i < cases(100); ++i) {
    CAPTURE(i);
    MatchSampler sample(1000 + static_cast<unsigned>(i));
    check_against_judge(sample.matches(sample.integer(2, 40), 0, sample.pose(1), 2, 0),
                        sample.uniform(0.05, 0.3));
  }
}

TEST_CASE("Inliers exactly at the threshold") {
  for (int i = 0; i < cases(300); ++i) {
    CAPTURE(i);
    MatchSampler sample(2000 + static_cast<unsigned>(i));
    const int count = sample.integer(2, 20), inliers = sample.integer(2, count);
    const double epsilon = sample.uniform(0.05, 0.3);
    check_against_judge(sample.matches(count, inliers, sample.pose(1), 1.5, epsilon, true), epsilon);
  }
}

TEST_CASE("Two matches that only just touch") {
  for (int i = 0; i < cases(200); ++i) {
    CAPTURE(i);
    MatchSampler sample(3000 + static_cast<unsigned>(i));
    const double epsilon = sample.uniform(0.05, 0.3);
    const Eigen::Isometry3d truth = sample.pose(1);
    const Eigen::Vector3d p = sample.point(1), shift = 2 * epsilon * sample.direction();
    // Both matches have the same source point: at every rotation their balls touch in one point.
    Matches matches = {{p, truth * p}, {p, truth * p + shift}};
    const int strangers = sample.integer(0, 4);
    for (int k = 0; k < strangers; ++k) matches.push_back({sample.point(1), sample.point(1)});
    check_against_judge(matches, epsilon);
    CHECK(judged_consensus({matches[0], matches[1]}, epsilon) == 2);
    CHECK(judged_consensus({matches[0], {p, truth * p + 1.01 * shift}}, epsilon) == 1);
  }
}

TEST_CASE("Duplicate points and duplicate matches") {
  for (int i = 0; i < cases(300); ++i) {
    CAPTURE(i);
    MatchSampler sample(4000 + static_cast<unsigned>(i));
    const double epsilon = sample.uniform(0.05, 0.2);
    Matches matches =
        sample.matches(sample.integer(2, 20), sample.integer(1, 8), sample.pose(1), 1.5, epsilon);
    const int copies = sample.integer(1, 30);
    for (int k = 0; k < copies; ++k) {
      const Match a =
          matches[static_cast<std::size_t>(sample.integer(0, static_cast<int>(matches.size()) - 1))];
      const Match b =
          matches[static_cast<std::size_t>(sample.integer(0, static_cast<int>(matches.size()) - 1))];
      matches.push_back({a.p, k % 3 == 0 ? a.q : b.q});
    }
    check_against_judge(matches, epsilon);
  }
}

TEST_CASE("Points on the axis") {
  for (int i = 0; i < cases(150); ++i) {
    CAPTURE(i);
    MatchSampler sample(5000 + static_cast<unsigned>(i));
    const double epsilon = sample.uniform(0.05, 0.3);
    const Eigen::Isometry3d truth = sample.pose(1);
    const Eigen::Vector3d foot = i % 2 == 0 ? Eigen::Vector3d(0, 0, 0) : sample.point(1);
    Matches matches;
    const int count = sample.integer(1, 30), beside = i % 3 == 0 ? 3 : 0;
    for (int k = 0; k < count + beside; ++k) {
      Eigen::Vector3d p = foot;
      p.z() = sample.uniform(-1, 1);
      if (k >= count) p += sample.point(0.5);
      matches.push_back(
          {p, k % 2 == 0 ? Eigen::Vector3d(truth * p + epsilon * sample.direction()) : sample.point(1)});
    }
    check_against_judge(matches, epsilon);
  }
}

TEST_CASE("Ties between two poses, and points on a lattice") {
  for (int i = 0; i < cases(150); ++i) {
    CAPTURE(i);
    MatchSampler sample(6000 + static_cast<unsigned>(i));
    const double epsilon = 0.125;
    Matches matches;
    const int count = sample.integer(2, 12);
    if (i % 2 == 0) {
      const Eigen::Isometry3d one = sample.pose(1), other = sample.pose(1);
      for (int k = 0; k < count; ++k) {
        const Eigen::Vector3d p = sample.point(1.5), r = sample.point(1.5);
        matches.push_back({p, one * p});
        matches.push_back({r, other * r});
      }
    } else {
      const auto lattice = [&] {
        return Eigen::Vector3d(0.25 * sample.integer(-4, 4), 0.25 * sample.integer(-4, 4),
                               0.25 * sample.integer(-2, 2));
      };
      for (int k = 0; k < 2 * count; ++k) matches.push_back({lattice(), lattice()});
    }
    check_against_judge(matches, epsilon);
  }
}

}  // namespace
}  // namespace scanlock
