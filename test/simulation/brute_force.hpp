// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "simulation/scene.hpp"

namespace scanlock {

/// The ground along a ray, found by marching and bisection: slow, and it shares no formula with Terrain.
inline double march_to_ground(const Terrain& terrain, const Ray& ray, double max_range) {
  const auto above = [&](double range) {
    const Eigen::Vector3d p = ray.origin + range * ray.direction;
    return p.z() - terrain.height(p.x(), p.y());
  };
  const auto inside = [&](double range) {
    const Eigen::Vector3d p = ray.origin + range * ray.direction;
    return p.x() >= terrain.low().x() && p.x() <= terrain.high().x() && p.y() >= terrain.low().y() &&
           p.y() <= terrain.high().y();
  };
  constexpr double kStep = 0.02;
  double height = above(0);
  for (double range = 0; range < max_range; range += kStep) {
    const double before = height;
    height = above(range + kStep);
    if (!inside(range + kStep) || before * height > 0) continue;
    double near = range, far = range + kStep;
    for (int i = 0; i < 40; ++i) (above(near) * above((near + far) / 2) > 0 ? near : far) = (near + far) / 2;
    return far;
  }
  return max_range;
}

/// Casts a ray against every shape, without the grid.
inline Hit cast_at_all(const Scene& scene, const Ray& ray, double max_range, std::uint64_t seed) {
  Hit hit;
  hit.range = max_range;
  const double ground = march_to_ground(scene.terrain(), ray, max_range);
  if (ground < max_range) {
    hit.range = ground;
    hit.found = true;
  }
  if (scene.ceiling()) intersect_ceiling(*scene.ceiling(), ray, hit);
  for (const Box& box : scene.boxes()) intersect(box, ray, hit);
  for (const Cylinder& cylinder : scene.cylinders()) intersect(cylinder, ray, hit);
  for (std::size_t i = 0; i < scene.ellipsoids().size(); ++i)
    intersect(scene.ellipsoids()[i], ray, Scene::leaf_bits(seed, i), hit);
  return hit;
}

/// Distance of a point from the nearest surface of boxes, cylinders (their mantles), ground and ceiling.
inline double distance_to_surfaces(const Scene& scene, const Eigen::Vector3d& p) {
  double nearest = std::abs(p.z() - scene.terrain().height(p.x(), p.y()));
  if (scene.ceiling()) nearest = std::min(nearest, std::abs(*scene.ceiling() - p.z()));
  for (const Box& box : scene.boxes()) {
    const Eigen::Vector3d q = (box.world_from_box.transpose() * (p - box.centre)).cwiseAbs() - box.half;
    const double outside = q.cwiseMax(0.0).norm(), inside = std::min(0.0, q.maxCoeff());
    nearest = std::min(nearest, std::abs(outside + inside));
  }
  for (const Cylinder& cylinder : scene.cylinders()) {
    const Eigen::Vector3d d = p - cylinder.base;
    const double along = d.dot(cylinder.axis);
    if (along < 0 || along > cylinder.length) continue;
    nearest = std::min(nearest, std::abs((d - along * cylinder.axis).norm() - cylinder.radius));
  }
  return nearest;
}

}  // namespace scanlock
