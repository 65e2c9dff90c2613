// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/max_consensus.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "judge.hpp"
#include "match_samples.hpp"

namespace scanlock {
namespace {

using Eigen::Vector3d;

TEST_CASE("A planted pose among many outliers") {
  MatchSampler sample(1);
  const Pose truth = sample.pose(10);
  const Matches matches = sample.matches(3000, 60, truth, 20, 0.1);
  MatchRegistrationOptions options;
  const MatchRegistration found = register_matches(matches, options);
  CHECK(found.certified);
  CHECK(found.consensus >= 60);
  CHECK(found.matches == 3000);
  CHECK(found.matches_after_pruning < 300);
  CHECK(angle_between(found.target_from_source, truth) < 0.01);
  CHECK((found.target_from_source * Vector3d(0, 0, 0) - truth * Vector3d(0, 0, 0)).norm() < 0.2);
  CHECK(counted_consensus(matches, options.epsilon, found.target_from_source) == found.consensus);
  for (const std::uint32_t i : found.inliers)
    CHECK((found.target_from_source * matches[i].p - matches[i].q).norm() <= options.epsilon * (1 + 1e-6));
  SUBCASE("the same without pruning") {
    options.prune = false;
    const MatchRegistration again = register_matches(matches, options);
    CHECK(again.consensus == found.consensus);
    CHECK(again.certified);
    CHECK(again.matches_after_pruning == 3000);
  }
  SUBCASE("the same twice, to the bit") {
    const MatchRegistration again = register_matches(matches, options);
    CHECK(again.target_from_source.matrix() == found.target_from_source.matrix());
    CHECK(again.runner_up.matrix() == found.runner_up.matrix());
    CHECK(again.nodes == found.nodes);
  }
}

TEST_CASE("Angles about 0 and 2 pi") {
  for (int i = -3; i <= 3; ++i) {
    MatchSampler sample(20);
    Pose truth = Pose::Identity();
    truth.linear() = Eigen::AngleAxisd(0.001 * i, Vector3d::UnitZ()).toRotationMatrix();
    truth.translation() = Vector3d(1, 2, 3);
    const MatchRegistration found = register_matches(sample.matches(300, 30, truth, 10, 0.05));
    CAPTURE(i);
    CHECK(found.consensus >= 30);
    CHECK(found.certified);
    CHECK(angle_between(found.target_from_source, truth) < 0.02);
  }
}

TEST_CASE("Far from the origin") {
  MatchSampler sample(3);
  Matches matches = sample.matches(500, 50, sample.pose(1), 10, 0.05);
  const MatchRegistration near = register_matches(matches);
  for (Match& m : matches) {
    m.p += Vector3d(4e5, -5e6, 300);
    m.q += Vector3d(-7e5, 2e6, 10);
  }
  const MatchRegistration far = register_matches(matches);
  CHECK(near.certified);
  CHECK(far.certified);
  CHECK(far.consensus == near.consensus);
}

TEST_CASE("One match ten thousand kilometres away changes nothing") {
  MatchSampler sample(4);
  Matches matches = sample.matches(1000, 50, sample.pose(5), 20, 0.05);
  const MatchRegistration before = register_matches(matches);
  matches.push_back({Vector3d(1e7, 0, 0), Vector3d(0, 1e7, 50)});
  matches.push_back({Vector3d(0, -1e7, 1e6), Vector3d(3, 1e7, 50)});
  const MatchRegistration after = register_matches(matches);
  CHECK(after.consensus == before.consensus);
  CHECK(after.certified);
}

TEST_CASE("Any axis of rotation") {
  MatchSampler sample(5);
  const Pose truth = sample.pose(5);
  const Matches matches = sample.matches(400, 40, truth, 10, 0.05);
  for (const Vector3d& up : {Vector3d(0, -1, 0), Vector3d(1, 2, 3), Vector3d(0, 0, -5)}) {
    const Eigen::Matrix3d turn = least_rotation(Vector3d::UnitZ(), up).toRotationMatrix();
    Matches turned = matches;
    for (Match& m : turned) {
      m.p = turn * m.p;
      m.q = turn * m.q;
    }
    MatchRegistrationOptions options;
    options.up = up;
    const MatchRegistration found = register_matches(turned, options);
    CHECK(found.consensus >= 40);
    CHECK(found.certified);
    CHECK((found.target_from_source.linear() * up - up).norm() < 1e-9);
    CHECK(counted_consensus(turned, options.epsilon, found.target_from_source) == found.consensus);
    const Pose expected = Pose(turn) * truth * Pose(Eigen::Matrix3d(turn.transpose()));
    CHECK(angle_between(found.target_from_source, expected) < 0.02);
  }
}

TEST_CASE("Tilted clouds keep their inliers when the tilt is allowed for") {
  MatchSampler sample(6);
  const double tilt = 0.02;
  int lost = 0;  // cases in which a search without tolerance misses inliers
  for (int i = 0; i < 10; ++i) {
    const Pose truth = sample.pose(5);
    Matches matches = sample.matches(500, 60, truth, 15, 0.02);
    const auto tilted = [&] {
      const Vector3d axis = Vector3d(sample.uniform(-1, 1), sample.uniform(-1, 1), 0).normalized();
      return Eigen::AngleAxisd(tilt, axis);
    };
    const auto p_tilt = tilted(), q_tilt = tilted();
    for (Match& m : matches) {
      m.p = p_tilt * m.p;
      m.q = q_tilt * m.q;
    }
    MatchRegistrationOptions options;
    options.epsilon = 0.05;
    const MatchRegistration stiff = register_matches(matches, options);
    lost += stiff.consensus < 60;
    options.tilt = tilt;
    const MatchRegistration found = register_matches(matches, options);
    CHECK(found.upper_bound >= 60);  // guaranteed by the certificate
    CHECK(found.certified);
    CHECK(angle_between(found.target_from_source, truth) < 0.1);
  }
  CHECK(lost > 5);
}

TEST_CASE("The runner-up is the second of two planted poses") {
  MatchSampler sample(7);
  Pose one = sample.pose(5), other = one;
  other.linear() = Eigen::AngleAxisd(3.14159265358979, Vector3d::UnitZ()).toRotationMatrix() * one.linear();
  Matches matches = sample.matches(500, 60, one, 15, 0.05);
  for (const Match& m : sample.matches(50, 50, other, 15, 0.05)) matches.push_back(m);
  const MatchRegistration found = register_matches(matches);
  CHECK(found.consensus >= 60);
  CHECK(angle_between(found.target_from_source, one) < 0.02);
  CHECK(found.runner_up_consensus >= 50);
  CHECK(found.runner_up_bound >= found.runner_up_consensus);
  CHECK(found.runner_up_bound < found.consensus);
  CHECK(angle_between(found.runner_up, other) < 0.02);
  CHECK(counted_consensus(matches, 0.1, found.runner_up) == found.runner_up_consensus);
}

TEST_CASE("find_runner_up finds the same runner-up as a search that includes it") {
  MatchSampler sample(17);
  const Pose one = sample.pose(5), other = sample.pose(5);
  Matches matches = sample.matches(500, 60, one, 15, 0.05);
  for (const Match& m : sample.matches(50, 50, other, 15, 0.05)) matches.push_back(m);
  MatchRegistrationOptions options;
  options.up = Vector3d(0.3, -0.2, 1);
  const MatchRegistration at_once = register_matches(matches, options);
  options.runner_up = false;
  MatchRegistration found = register_matches(matches, options);
  CHECK(found.runner_up_bound == found.consensus);
  find_runner_up(matches, options, &found);
  CHECK(found.consensus == at_once.consensus);
  CHECK(found.target_from_source.matrix() == at_once.target_from_source.matrix());
  CHECK(found.runner_up_consensus == at_once.runner_up_consensus);
  CHECK(found.runner_up_bound == at_once.runner_up_bound);
  CHECK(found.runner_up_bound < found.consensus);
  CHECK(counted_consensus(matches, 0.1, found.runner_up) == found.runner_up_consensus);
}

TEST_CASE("A unique pose has a weak runner-up") {
  MatchSampler sample(8);
  const MatchRegistration found = register_matches(sample.matches(400, 80, sample.pose(5), 15, 0.05));
  CHECK(found.runner_up_consensus < 10);
  CHECK(found.runner_up_bound <= found.consensus / 2);
}

TEST_CASE("A search that ends at its budget has a valid upper bound") {
  MatchSampler sample(9);
  const Matches matches = sample.matches(3000, 5, sample.pose(5), 10, 0.1);
  MatchRegistrationOptions options;
  for (const bool prune : {true, false}) {
    options.prune = prune;
    for (const std::size_t nodes : {0, 1, 10, 100, 1000}) {
      options.max_nodes = nodes;
      const MatchRegistration found = register_matches(matches, options);
      CHECK(found.upper_bound >= found.consensus);
      CHECK(found.upper_bound >= 5);
      CHECK(found.certified == (found.upper_bound == found.consensus));
      CHECK(found.nodes <= nodes);
    }
  }
  options.max_nodes = std::numeric_limits<std::size_t>::max();
  options.budget_s = 0;
  const MatchRegistration none = register_matches(matches, options);
  CHECK_FALSE(none.certified);
  CHECK(none.upper_bound >= 5);
}

TEST_CASE("Few matches, equal matches, and none") {
  CHECK(register_matches({}).consensus == 0);
  CHECK(register_matches({}).certified);
  const Match one{Vector3d(1, 2, 3), Vector3d(-4, 5, 6)};
  const MatchRegistration single = register_matches({one});
  CHECK(single.consensus == 1);
  CHECK(single.certified);
  CHECK((single.target_from_source * one.p - one.q).norm() <= 0.1 * (1 + 1e-9));
  for (const std::size_t count : {2, 60, 5000}) {
    const MatchRegistration equal = register_matches(Matches(count, one));
    CHECK(equal.consensus == static_cast<int>(count));
    CHECK(equal.certified);
  }
}

TEST_CASE("Invalid options and matches are refused with a message") {
  const Matches one = {{Vector3d(1, 2, 3), Vector3d(4, 5, 6)}};
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto refused = [&](auto change) {
    MatchRegistrationOptions options;
    change(options);
    CHECK_THROWS_AS(register_matches(one, options), std::invalid_argument);
  };
  for (const double epsilon : {0.0, -1.0, nan, infinity})
    refused([&](MatchRegistrationOptions& o) { o.epsilon = epsilon; });
  refused([&](MatchRegistrationOptions& o) { o.up.setZero(); });
  refused([&](MatchRegistrationOptions& o) { o.up.x() = nan; });
  refused([&](MatchRegistrationOptions& o) { o.tilt = -0.1; });
  refused([&](MatchRegistrationOptions& o) { o.budget_s = nan; });
  for (const double bad : {nan, infinity, 1e300}) {
    Matches matches = one;
    matches.push_back({Vector3d(0, bad, 0), Vector3d(0, 0, 0)});
    CHECK_THROWS_WITH_AS(register_matches(matches), doctest::Contains("match 1 "), std::invalid_argument);
  }
}

}  // namespace
}  // namespace scanlock
