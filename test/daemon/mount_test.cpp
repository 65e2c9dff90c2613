// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/mount.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

namespace {

Pose some_mount() {
  Vector6 xi;
  xi << 0.4, -0.2, 1.1, 0.05, -0.3, 1.2;
  return se3_exp(xi);
}

Pose some_motion() {
  Vector6 xi;
  xi << 2, 1, -0.3, 0.1, 0.2, -0.7;
  return se3_exp(xi);
}

}  // namespace

TEST_CASE("an identity mount changes nothing") {
  TrackedScan tracked;
  tracked.map_from_body = some_motion();
  tracked.twist << 1, 2, 3, 4, 5, 6;
  tracked.covariance = Matrix6::Identity();
  tracked.degenerate_axes = 0b010001;
  const TrackedScan body = seen_from_body(tracked, Pose::Identity());
  CHECK(body.map_from_body.isApprox(tracked.map_from_body));
  CHECK(body.twist.isApprox(tracked.twist));
  CHECK(body.covariance.isApprox(tracked.covariance));
  CHECK(body.degenerate_axes == tracked.degenerate_axes);
}

TEST_CASE("the motion of the body follows from the motion of the sensor and the mount") {
  // A body that moves by B moves its sensor from M to B M; the sensor's own motion is M^-1 B M.
  const Pose mount = some_mount(), body_motion = some_motion();
  TrackedScan tracked;
  tracked.map_from_body = mount.inverse() * body_motion * mount;
  CHECK(seen_from_body(tracked, mount).map_from_body.isApprox(body_motion));
}

TEST_CASE("the twist is the derivative of the body's pose") {
  const Pose mount = some_mount();
  TrackedScan now, later;
  now.map_from_body = some_motion();
  now.twist << 0.5, -1, 0.2, 0.1, 0.3, -0.4;
  const double dt = 1e-6;
  later.map_from_body = now.map_from_body * se3_exp(now.twist * dt);
  const TrackedScan a = seen_from_body(now, mount), b = seen_from_body(later, mount);
  const Vector6 measured = se3_log(a.map_from_body.inverse() * b.map_from_body) / dt;
  CHECK((measured - a.twist).norm() < 1e-4);
}

TEST_CASE("a sensor turned left sees its forward axis as the body's left") {
  TrackedScan tracked;
  tracked.degenerate_axes = 0b001001;  // x and rotation about x
  Pose mount = Pose::Identity();
  mount.linear() = so3_exp(Eigen::Vector3d(0, 0, 1.5707963));
  CHECK(seen_from_body(tracked, mount).degenerate_axes == 0b010010);
}
