// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <random>

#include "geometry/moved_cloud.hpp"
#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock::test {

struct Random {
  std::mt19937 engine;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  explicit Random(unsigned seed) : engine(seed) {}
  double number() { return normal(engine); }
  double between(double low, double high) { return low + (high - low) * uniform(engine); }
  Eigen::Vector3d vector() { return {number(), number(), number()}; }
};

/// A room of 8 x 6 x 3 m with a box and a slanted board in it, sampled at random, with normals; `noise`:
/// metres, along the normals. The room has no symmetry.
inline PointCloud room(Random& random, std::size_t n, double noise = 0) {
  struct Patch {
    Eigen::Vector3d corner, a, b;
  };
  const Patch patches[] = {{{-4, -3, 0}, {8, 0, 0}, {0, 6, 0}},   {{-4, -3, 0}, {8, 0, 0}, {0, 0, 3}},
                           {{-4, -3, 0}, {0, 6, 0}, {0, 0, 3}},   {{4, -3, 0}, {0, 6, 0}, {0, 0, 2}},
                           {{1, 0.5, 1}, {1, 0, 0}, {0, 1.5, 0}}, {{1, 0.5, 0}, {1, 0, 0}, {0, 0, 1}},
                           {{-3, 1, 0}, {1, 1, 0.3}, {0, 0, 1.6}}};
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const Patch& patch = patches[i % 7];
    const Eigen::Vector3d normal = patch.a.cross(patch.b).normalized();
    const Eigen::Vector3d p = patch.corner + random.between(0, 1) * patch.a + random.between(0, 1) * patch.b;
    cloud.push_back(Eigen::Vector3f((p + noise * random.number() * normal).cast<float>()));
    cloud.nx.push_back(static_cast<float>(normal.x()));
    cloud.ny.push_back(static_cast<float>(normal.y()));
    cloud.nz.push_back(static_cast<float>(normal.z()));
  }
  return cloud;
}

inline Pose motion(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation) {
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp(rotation);
  pose.translation() = translation;
  return pose;
}

}  // namespace scanlock::test
