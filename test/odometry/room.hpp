// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "geometry/voxel_grid.hpp"

namespace scanlock {

/// The range, metres, to the walls, the floor or the ceiling of a hall of 24 x 16 x 5 m.
inline double walls_range(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  double nearest = 1e9;
  const Eigen::Vector3d low(-12, -8, -1), high(12, 8, 4);
  for (int axis = 0; axis < 3; ++axis) {
    for (double wall : {low[axis], high[axis]}) {
      const double t = (wall - from[axis]) / direction[axis];
      if (t > 1e-6 && t < nearest) nearest = t;
    }
  }
  return nearest;
}

/// The hall with four columns, seen by a sensor that fires random rays over `sweep_s` seconds while it moves
/// with a constant body velocity; ranges are exact.
inline double hall_range(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  double nearest = walls_range(from, direction);
  for (const Eigen::Vector2d& centre : {Eigen::Vector2d(4, 3), Eigen::Vector2d(-5, 2), Eigen::Vector2d(2, -5),
                                        Eigen::Vector2d(-7, -4.5)}) {  // square columns, 1 m wide
    for (int axis = 0; axis < 2; ++axis) {
      for (double side : {-0.5, 0.5}) {
        const double t = (centre[axis] + side - from[axis]) / direction[axis];
        const Eigen::Vector3d hit = from + t * direction;
        if (t > 1e-6 && t < nearest && std::abs(hit[1 - axis] - centre[1 - axis]) <= 0.5) nearest = t;
      }
    }
  }
  return nearest;
}

/// A twist with a rotation, or a rate of rotation, about the z axis only.
inline Vector6 yaw(double angle) {
  Vector6 xi = Vector6::Zero();
  xi[5] = angle;
  return xi;
}

/// A pose in the plane: metres, radians.
inline Pose at(double x, double y, double heading) {
  Pose pose = se3_exp(yaw(heading));
  pose.translation() << x, y, 0;
  return pose;
}

inline Scan hall_scan(const Pose& pose, const Vector6& twist, std::int64_t utime, unsigned seed,
                      double sweep_s = 0.1, int rays = 6000) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Scan scan;
  scan.utime = utime;
  for (int i = 0; i < rays; ++i) {
    const double azimuth = 3.14159265358979 * uniform(rng), elevation = 0.5 * uniform(rng);
    const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const float time = static_cast<float>(sweep_s * i / rays);
    const Pose at = pose * se3_exp(static_cast<double>(time) * twist);
    const Eigen::Vector3d p = ray * hall_range(at.translation(), at.linear() * ray);
    scan.points.push_back(p.cast<float>());
    scan.points.time.push_back(time);
  }
  return scan;
}

/// The same scan with the sensor covered, except for points for which `sees(x, y, z)` is true.
template <class Sees>
Scan covered(const Scan& scan, const Sees& sees) {
  std::vector<std::uint32_t> seen;
  for (std::uint32_t i = 0; i < scan.points.size(); ++i) {
    if (sees(scan.points.x[i], scan.points.y[i], scan.points.z[i])) seen.push_back(i);
  }
  Scan rest;
  rest.utime = scan.utime;
  rest.points = select(scan.points, seen);
  return rest;
}

/// The same scan with the left half of the view covered.
inline Scan half_of(const Scan& scan) {
  return covered(scan, [](float, float y, float) { return !(y > 0); });
}

/// 250 points of the hall without columns, which looks the same after half a turn.
inline Scan bare_hall_scan(const Pose& pose, std::int64_t utime, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Scan scan;
  scan.utime = utime;
  for (int i = 0; i < 250; ++i) {
    const double azimuth = 3.14159265358979 * uniform(random), elevation = 0.4 * uniform(random);
    const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const double range = walls_range(pose.translation(), pose.linear() * ray);
    scan.points.push_back((range * ray).cast<float>());
    scan.points.time.push_back(0);
  }
  return scan;
}

/// The same hall, seen by a planar sensor with one beam per degree; ranges have noise.
inline Scan planar_hall_scan(const Pose& pose, const Vector6& twist, std::int64_t utime, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> noise(0, 0.01);
  Scan scan;
  scan.utime = utime;
  for (int beam = 0; beam < 360; ++beam) {
    const double time = 0.1 * beam / 360, azimuth = (beam - 180) * 3.14159265358979 / 180;
    const Pose at = pose * se3_exp(time * twist);
    const Eigen::Vector3d ray(std::cos(azimuth), std::sin(azimuth), 0);
    const double range = hall_range(at.translation(), at.linear() * ray) + noise(rng);
    scan.points.push_back((range * ray).cast<float>());
    scan.points.time.push_back(static_cast<float>(time));
  }
  return scan;
}

/// A nook of 2.1 x 1.2 m with a step in one of its walls, seen by a planar sensor of 180 degrees that turns
/// on the spot: five scans a second, without times of the beams.
inline Scan nook_scan(double heading, int i) {
  std::mt19937 rng(static_cast<unsigned>(i));
  std::normal_distribution<double> noise(0, 0.01);
  Scan scan;
  scan.utime = 200000 * static_cast<std::int64_t>(i);
  for (int beam = 0; beam < 181; ++beam) {
    const Eigen::Vector3d ray = se3_exp(yaw((beam - 90) * 3.14159265358979 / 180)).linear().col(0),
                          at = se3_exp(yaw(heading)).linear() * ray;
    const double to_side = (at.x() > 0 ? 1.35 : -0.75) / at.x();
    const double to_end = (at.y() < 0 ? -0.5 : at.x() > 0 ? 0.4 : 0.7) / at.y();
    const double range = std::min(to_side, to_end) + noise(rng);
    scan.points.push_back((range * ray).cast<float>());
  }
  return scan;
}

}  // namespace scanlock
