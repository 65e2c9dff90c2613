// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/metrics.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

Pose at(double x, double y, double z, double yaw = 0) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(x, y, z));
  pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return pose;
}

/// A straight path along x from 0 on, with 1 m and 0.1 s per pose; the estimate is `scale` times as long.
PosePairs straight(int poses, double scale, double yaw_per_metre = 0) {
  Trajectory estimate, reference;
  for (int i = 0; i < poses; ++i) {
    reference.push_back({0.1 * i, at(i, 0, 0)});
    estimate.push_back({0.1 * i, at(scale * i, 0, 0, yaw_per_metre * i)});
  }
  return match_by_time(estimate, reference);
}

/// A closed path with changes of height, without symmetry.
PosePairs moved_by(const Pose& estimate_from_reference) {
  PosePairs pairs;
  for (int i = 0; i < 100; ++i) {
    const double a = 0.06 * i;
    const Pose reference = at(10 * std::cos(a), 6 * std::sin(2 * a), 0.5 * std::sin(3 * a) + a, a);
    pairs.push_back({0.1 * i, 1.0 * i, estimate_from_reference * reference, reference});
  }
  return pairs;
}

}  // namespace

TEST_CASE("equal trajectories have no error") {
  const Evaluation result = evaluate(straight(1001, 1), 1001, Overlay::kNone);
  CHECK(result.matched == 1001);
  CHECK(result.length_m == doctest::Approx(1000));
  CHECK(result.ate_m.max == 0);
  REQUIRE(result.rpe[2]);
  CHECK(result.rpe[2]->percent == doctest::Approx(0));
  REQUIRE(result.kitti);
  CHECK(result.kitti->percent == doctest::Approx(0));
  CHECK(result.kitti->deg_per_m == doctest::Approx(0));
}

TEST_CASE("one percent of scale is one percent at every length") {
  const Evaluation result = evaluate(straight(1001, 1.01), 1001, Overlay::kNone);
  for (const auto& rpe : result.rpe) {
    REQUIRE(rpe);
    CHECK(rpe->percent == doctest::Approx(1));
    CHECK(rpe->deg_per_m < 1e-9);
  }
  CHECK(result.rpe[0]->stretches == 1000);
  CHECK(result.rpe[2]->stretches == 901);
  REQUIRE(result.kitti);
  CHECK(result.kitti->percent == doctest::Approx(1));
  // Every tenth of 1001 poses, to 100, 200 .. 800 m further on: 91 + 81 + .. + 21.
  CHECK(result.kitti->stretches == 448);
  // Errors 0, 0.01 .. 10 m.
  CHECK(result.ate_m.max == doctest::Approx(10));
  CHECK(result.ate_m.median == doctest::Approx(5));
  CHECK(result.ate_m.rmse == doctest::Approx(0.01 * std::sqrt(1000 * 2001 / 6.0)));
}

TEST_CASE("a heading error of 0.1 degrees per metre is reported as such") {
  const Evaluation result = evaluate(straight(201, 1, 0.1 * kPi / 180), 201, Overlay::kNone);
  for (const auto& rpe : result.rpe) CHECK(rpe.value().deg_per_m == doctest::Approx(0.1));
  CHECK(result.ate_m.max == 0);
  // From the first pose, where both headings are equal, 10 m lead to the same position.
  CHECK(relative_error(straight(11, 1, 0.1 * kPi / 180), 10).value().percent ==
        doctest::Approx(0).epsilon(1e-9));
}

TEST_CASE("lengths that exceed the path have no value") {
  const Evaluation result = evaluate(straight(51, 1), 51, Overlay::kNone);
  CHECK(result.rpe[0]);
  CHECK(result.rpe[1]);
  CHECK_FALSE(result.rpe[2]);
  CHECK_FALSE(result.kitti);
}

TEST_CASE("the relative error of a segment is divided by its real length") {
  // 3 m from pose to pose, so that the first pose at least 1 m further on is 3 m further on.
  Trajectory estimate, reference;
  for (int i = 0; i < 5; ++i) {
    reference.push_back({1.0 * i, at(3 * i, 0, 0)});
    estimate.push_back({1.0 * i, at(3.3 * i, 0, 0)});
  }
  CHECK(relative_error(match_by_time(estimate, reference), 1).value().percent == doctest::Approx(10));
}

TEST_CASE("each overlay removes exactly the motion that it may remove") {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = uniform(rng);
  const PosePairs tilted = moved_by(se3_exp(xi));
  CHECK(evaluate(tilted, 100, Overlay::kSe3).ate_m.max < 1e-12);
  CHECK(evaluate(tilted, 100, Overlay::kYaw).ate_m.max > 0.1);
  CHECK(evaluate(tilted, 100, Overlay::kNone).ate_m.max > 0.1);
  for (const double yaw : {-3.0, -0.5, 0.01, 2.0}) {
    const PosePairs turned = moved_by(at(5, -7, 2, yaw));
    const Evaluation result = evaluate(turned, 100, Overlay::kYaw);
    CHECK(result.ate_m.max < 1e-12);
    CHECK((result.reference_from_estimate * at(5, -7, 2, yaw)).isApprox(Pose::Identity(), 1e-12));
    CHECK(evaluate(turned, 100, Overlay::kNone).rpe[1].value().percent <
          1e-9);  // relative errors need no alignment of the trajectories
  }
  CHECK_THROWS_AS(evaluate({}, 5, Overlay::kNone), std::runtime_error);
  CHECK_THROWS_AS(evaluate(straight(2, 1), 2, Overlay::kSe3), std::runtime_error);
}

TEST_CASE("matching by time takes the nearest within the tolerance and each reference once") {
  Trajectory reference, estimate;
  for (int i = 0; i < 10; ++i) reference.push_back({1e9 + 0.1 * i, at(i, 0, 0)});
  estimate.push_back({1e9 + 0.309, at(3, 1, 0)});  // out of order, too far from the next
  estimate.push_back({1e9 + 0.004, at(0, 1, 0)});
  estimate.push_back({1e9 + 0.050, at(0, 2, 0)});   // no reference pose nearby
  estimate.push_back({1e9 + 0.295, at(3, 3, 0)});   // nearer to 0.3 than the first
  estimate.push_back({1e9 + 0.910, at(9, 1, 0)});   // just within
  estimate.push_back({1e9 + 0.9101, at(9, 2, 0)});  // just beyond
  const PosePairs pairs = match_by_time(estimate, reference);
  REQUIRE(pairs.size() == 3);
  CHECK(pairs[0].estimate.translation().y() == 1);
  CHECK(pairs[1].estimate.translation().y() == 3);
  CHECK(pairs[1].way_m == doctest::Approx(3));  // along the whole reference, not only along the matches
  CHECK(pairs[2].estimate.translation().x() == 9);
  CHECK(match_by_time({}, reference).empty());
  CHECK(match_by_time(estimate, {}).empty());
  CHECK(match_by_number(estimate, reference).size() == 6);
}

}  // namespace scanlock
