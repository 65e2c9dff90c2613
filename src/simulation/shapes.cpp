// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "geometry/rigid.hpp"
#include "simulation/random.hpp"

namespace scanlock {

Box Box::upright(const Eigen::Vector3d& bottom, double yaw, const Eigen::Vector3d& size,
                 double reflectivity) {
  Box box;
  box.half = size / 2;
  box.centre = bottom + Eigen::Vector3d(0, 0, size.z() / 2);
  box.world_from_box = rotation_about_z(yaw);
  box.reflectivity = reflectivity;
  return box;
}

void intersect(const Box& box, const Ray& ray, Hit& hit) {
  const Eigen::Vector3d origin = box.world_from_box.transpose() * (ray.origin - box.centre);
  const Eigen::Vector3d direction = box.world_from_box.transpose() * ray.direction;
  double enter = 0, leave = hit.range;
  int face = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = origin[axis], d = direction[axis], h = box.half[axis];
    if (std::abs(d) < 1e-15) {
      if (std::abs(o) > h) return;
      continue;
    }
    const double inverse = 1 / d;
    const double a = (-h - o) * inverse, b = (h - o) * inverse;
    const double near_side = std::min(a, b), far_side = std::max(a, b);
    if (near_side > enter) {
      enter = near_side;
      face = axis;
    }
    leave = std::min(leave, far_side);
    if (enter >= leave) return;
  }
  if (face < 0) return;  // the ray starts inside
  hit.range = enter;
  hit.found = true;
  hit.normal = box.world_from_box.col(face) * (direction[face] > 0 ? -1.0 : 1.0);
  hit.reflectivity = box.reflectivity;
}

void intersect(const Cylinder& cylinder, const Ray& ray, Hit& hit) {
  const Eigen::Vector3d origin = ray.origin - cylinder.base;
  const double origin_along = origin.dot(cylinder.axis), direction_along = ray.direction.dot(cylinder.axis);
  const Eigen::Vector3d across = origin - origin_along * cylinder.axis;
  const Eigen::Vector3d step = ray.direction - direction_along * cylinder.axis;
  const double a = step.squaredNorm();
  if (a < 1e-15) return;
  const double b = across.dot(step);
  const double c = across.squaredNorm() - cylinder.radius * cylinder.radius;
  const double discriminant = b * b - a * c;
  if (c < 0 || b > 0 || discriminant < 0) return;
  const double range = (-b - std::sqrt(discriminant)) / a;
  if (range <= 0 || range >= hit.range) return;
  const double along = origin_along + range * direction_along;
  if (along < 0 || along > cylinder.length) return;
  hit.range = range;
  hit.found = true;
  hit.normal = (across + range * step) / cylinder.radius;
  hit.reflectivity = cylinder.reflectivity;
}

void intersect(const Ellipsoid& ellipsoid, const Ray& ray, std::uint64_t random_bits, Hit& hit) {
  const Eigen::Vector3d origin = (ray.origin - ellipsoid.centre).cwiseQuotient(ellipsoid.radii);
  const Eigen::Vector3d step = ray.direction.cwiseQuotient(ellipsoid.radii);
  const double a = step.squaredNorm(), b = origin.dot(step), c = origin.squaredNorm() - 1;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return;
  const double root = std::sqrt(discriminant);
  double range = (-b - root) / a;
  if (ellipsoid.density > 0) {
    const double enter = std::max(0.0, range), leave = (-b + root) / a;
    range = enter - log(1 - unit_interval(random_bits)) / ellipsoid.density;
    if (range >= leave) return;
  }
  if (range <= 0 || range >= hit.range) return;
  hit.range = range;
  hit.found = true;
  // A leaf may face any way; the normal of the ellipsoid would make every ray at the rim of a crown a grazing
  // ray.
  hit.normal = ellipsoid.density > 0
                   ? Eigen::Vector3d(-ray.direction)
                   : Eigen::Vector3d((origin + range * step).cwiseQuotient(ellipsoid.radii).normalized());
  hit.reflectivity = ellipsoid.reflectivity;
}

Bounds bounds_of(const Box& box) {
  const Eigen::Vector3d reach = box.world_from_box.cwiseAbs() * box.half;
  return {box.centre - reach, box.centre + reach};
}

Bounds bounds_of(const Cylinder& cylinder) {
  const Eigen::Vector3d top = cylinder.base + cylinder.length * cylinder.axis;
  // The disc at each end extends r sqrt(1 - a_i^2) along world axis i.
  const Eigen::Vector3d reach =
      cylinder.radius * (1 - cylinder.axis.array().square()).max(0.0).sqrt().matrix();
  return {cylinder.base.cwiseMin(top) - reach, cylinder.base.cwiseMax(top) + reach};
}

Bounds bounds_of(const Ellipsoid& ellipsoid) {
  return {ellipsoid.centre - ellipsoid.radii, ellipsoid.centre + ellipsoid.radii};
}

}  // namespace scanlock
