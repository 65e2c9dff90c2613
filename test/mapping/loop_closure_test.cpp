// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/loop_closure.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "../odometry/room.hpp"

namespace scanlock {
namespace {

Pose at(double x, double y, double heading) {
  Pose pose = se3_exp(yaw(heading));
  pose.translation() << x, y, 0;
  return pose;
}

/// What is seen in the hall from `truth`, believed to be seen from `believed`.
ArchivedKeyframe keyframe(std::uint32_t id, const Pose& truth, const Pose& believed) {
  PointCloud points = hall_scan(truth, Vector6::Zero(), 0, id).points;
  points.time.clear();
  ArchivedKeyframe k;
  k.id = id;
  k.reach = 8;
  k.map_from_body = believed;
  k.points = std::make_shared<const PointCloud>(std::move(points));
  return k;
}

/// Two visits of the hall, the second one believed to be `off` from where it is.
ClosureRequest two_visits(const Pose& off, double metres, double radians) {
  ClosureRequest request;
  for (std::uint32_t i = 1; i < 7; ++i) {
    const Pose first = at(-5 + 1.4 * i, 0.3, 0.1 * i), second = at(-4.5 + 1.4 * i, -0.6, 2.0);
    request.earlier.push_back(keyframe(i, first, first));
    request.recent.push_back(keyframe(10 + i, second, off * second));
  }
  request.keyframe = request.recent.back();
  request.recent.pop_back();
  request.nearest = 6;
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  request.covariance = sigma.cwiseAbs2().asDiagonal();
  request.voxel = 0.15;
  request.usual.sigma = 0.03;
  return request;
}

}  // namespace

TEST_CASE("a loop is closed to centimetres where the second visit is as far off as is allowed for") {
  const Pose off = at(0.4, -0.3, 0.05);
  const ClosureAnswer answer = close_loop(two_visits(off, 0.3, 0.04), {});
  CAPTURE(answer.reason);
  REQUIRE(answer.found);
  CHECK(answer.constraint.from == 6);
  CHECK(answer.constraint.to == 16);
  CHECK(answer.constraint.loop_closure);
  const Pose truth = at(-5 + 1.4 * 6, 0.3, 0.6).inverse() * at(-4.5 + 1.4 * 6, -0.6, 2.0);
  const Vector6 error = se3_log(truth.inverse() * answer.constraint.from_to);
  CHECK(error.head<3>().norm() < 0.02);
  CHECK(error.tail<3>().norm() < 0.004);
  CHECK(error.dot(answer.constraint.information * error) < kOnceInThousand);
}

TEST_CASE("no loop is closed farther off than odometry can be, nor where something else stands") {
  CHECK_FALSE(close_loop(two_visits(at(0.4, -0.3, 0.05), 0.03, 0.004), {}).found);
  ClosureRequest request = two_visits(Pose::Identity(), 0.3, 0.04);
  for (ArchivedKeyframe& k : request.earlier) {  // another hall, half as long
    PointCloud other = *k.points;
    for (float& x : other.x) x *= 0.5F;
    k.points = std::make_shared<const PointCloud>(std::move(other));
  }
  const ClosureAnswer answer = close_loop(request, {});
  CAPTURE(answer.reason);
  CHECK_FALSE(answer.found);
}

}  // namespace scanlock
