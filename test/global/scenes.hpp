// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "geometry/angles.hpp"
#include "geometry/moved_cloud.hpp"

namespace scanlock {

/// A yard: ground, boxes of all sizes and some poles, seen from (0, 0, 2). `seed` determines the objects,
/// `sampling` the points on them.
inline PointCloud yard(unsigned seed, unsigned sampling) {
  std::mt19937 place(seed), sample(sampling);
  const auto uniform = [](std::mt19937& rng, double low, double high) {
    return low + (high - low) * static_cast<double>(rng()) / 4294967295.0;
  };
  PointCloud cloud;
  const auto add = [&](double x, double y, double z) {
    cloud.push_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z - 2));
  };
  for (int k = 0; k < 12000; ++k)
    add(uniform(sample, -30, 30), uniform(sample, -30, 30), uniform(sample, 0, 0.02));
  for (int box = 0; box < 24; ++box) {
    const double x = uniform(place, -28, 28), y = uniform(place, -28, 28), turn = uniform(place, 0, 6.28);
    const double a = uniform(place, 0.5, 4), b = uniform(place, 0.5, 4), h = uniform(place, 0.5, 6);
    for (int k = 0; k < 700; ++k) {
      const double side = uniform(sample, -1, 1), z = uniform(sample, 0, h);
      const double u = k % 2 == 0 ? side * a : (k % 4 == 1 ? a : -a);
      const double v = k % 2 == 0 ? (k % 4 == 0 ? b : -b) : side * b;
      add(x + std::cos(turn) * u - std::sin(turn) * v, y + std::sin(turn) * u + std::cos(turn) * v, z);
    }
  }
  return cloud;
}

/// A vaulted tunnel along x as scanned by 16 beams; the scan is the same from every position in it.
inline PointCloud scanned_tunnel(unsigned sampling) {
  std::mt19937 rng(sampling);
  std::normal_distribution<double> noise(0, 0.01);
  PointCloud cloud;
  for (int beam = 0; beam < 16; ++beam) {
    const double elevation = (2 * beam - 15) * kDegree;
    for (int k = 0; k < 1800; ++k) {
      const double azimuth = 0.2 * k * kDegree;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double wall = (3.0 + 1.5 * (ray.y() > 0)) / std::abs(ray.y());  // nearer on one side
      const double level = ray.z() > 0 ? 4.0 / ray.z() : 1.5 / -ray.z();
      const double range = std::min(wall, level) + noise(rng);
      if (range < 60) cloud.push_back((range * ray).cast<float>());
    }
  }
  return cloud;
}

inline Pose level_pose(double yaw, double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

}  // namespace scanlock
