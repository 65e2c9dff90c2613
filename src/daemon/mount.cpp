// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/mount.hpp"

#include <cmath>

namespace scanlock {
namespace {

/// An axis of the body is degenerate when it is within 60 degrees of a degenerate axis of the sensor.
std::uint32_t turned_axes(std::uint32_t sensor_axes, const Eigen::Matrix3d& body_from_sensor) {
  constexpr double kGoodPart = 0.5;  // cos 60 degrees; every direction is within 60 degrees of a body axis
  std::uint32_t body_axes = 0;
  for (int block = 0; block < 2; ++block) {
    for (int sensor = 0; sensor < 3; ++sensor) {
      if ((sensor_axes >> (3 * block + sensor) & 1u) == 0) continue;
      for (int body = 0; body < 3; ++body) {
        if (std::abs(body_from_sensor(body, sensor)) >= kGoodPart) body_axes |= 1u << (3 * block + body);
      }
    }
  }
  return body_axes;
}

}  // namespace

TrackedScan seen_from_body(TrackedScan tracked, const Pose& body_from_sensor) {
  // P_body = M P_sensor M^-1; hence P_sensor exp(xi) becomes P_body exp(Ad(M) xi).
  const Matrix6 to_body = adjoint(body_from_sensor);
  for (Pose* pose : {&tracked.map_from_body, &tracked.local_from_body})
    *pose = body_from_sensor * *pose * body_from_sensor.inverse();
  if (tracked.recovery) {
    for (Pose* pose : {&tracked.recovery->map_from_body, &tracked.recovery->map_from_predicted})
      *pose = body_from_sensor * *pose * body_from_sensor.inverse();
  }
  tracked.twist = to_body * tracked.twist;
  tracked.covariance = to_body * tracked.covariance * to_body.transpose();
  tracked.degenerate_axes = turned_axes(tracked.degenerate_axes, body_from_sensor.linear());
  return tracked;
}

}  // namespace scanlock
