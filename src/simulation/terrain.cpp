// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/terrain.hpp"

#include <algorithm>
#include <cmath>

namespace scanlock {

Terrain::Terrain(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double cell,
                 const std::function<double(double x, double y)>& height)
    : low_(low),
      cell_(cell),
      columns_(static_cast<int>(std::ceil((high.x() - low.x()) / cell))),
      rows_(static_cast<int>(std::ceil((high.y() - low.y()) / cell))) {
  heights_.reserve(static_cast<std::size_t>((columns_ + 1) * (rows_ + 1)));
  for (int row = 0; row <= rows_; ++row)
    for (int column = 0; column <= columns_; ++column)
      heights_.push_back(height(low.x() + column * cell, low.y() + row * cell));
}

double Terrain::height(double x, double y) const {
  const double u = std::clamp((x - low_.x()) / cell_, 0.0, static_cast<double>(columns_));
  const double v = std::clamp((y - low_.y()) / cell_, 0.0, static_cast<double>(rows_));
  const int column = std::min(static_cast<int>(u), columns_ - 1),
            row = std::min(static_cast<int>(v), rows_ - 1);
  const double a = u - column, b = v - row;
  return (1 - b) * ((1 - a) * corner(column, row) + a * corner(column + 1, row)) +
         b * ((1 - a) * corner(column, row + 1) + a * corner(column + 1, row + 1));
}

double Terrain::highest(int column, int row) const {
  return std::max(
      {corner(column, row), corner(column + 1, row), corner(column, row + 1), corner(column + 1, row + 1)});
}

double Terrain::lowest(int column, int row) const {
  return std::min(
      {corner(column, row), corner(column + 1, row), corner(column, row + 1), corner(column + 1, row + 1)});
}

void Terrain::intersect_cell(int column, int row, const Ray& ray, double enter, double leave,
                             Hit& hit) const {
  // In units of cells the patch is z = z0 + zu u + zv v + zuv u v; its height along the ray is therefore a
  // parabola.
  const double z0 = corner(column, row), zu = corner(column + 1, row) - z0, zv = corner(column, row + 1) - z0;
  const double zuv = corner(column + 1, row + 1) - z0 - zu - zv;
  const double u = (ray.origin.x() - low_.x()) / cell_ - column, du = ray.direction.x() / cell_;
  const double v = (ray.origin.y() - low_.y()) / cell_ - row, dv = ray.direction.y() / cell_;
  const double c = ray.origin.z() - (z0 + zu * u + zv * v + zuv * u * v);
  const double b = ray.direction.z() - (zu * du + zv * dv + zuv * (u * dv + v * du));
  const double a = -zuv * du * dv;

  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return;
  // The form without cancellation, valid also for a = 0.
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  const double first = a != 0 ? q / a : HUGE_VAL, second = q != 0 ? c / q : HUGE_VAL;
  constexpr double kSlack = 1e-7;  // a root on the border counts for both cells
  double range = HUGE_VAL;
  for (const double root : {first, second})
    if (root > 0 && root >= enter - kSlack && root <= leave + kSlack) range = std::min(range, root);
  if (range >= hit.range) return;

  const double hit_u = u + range * du, hit_v = v + range * dv;
  hit.range = range;
  hit.found = true;
  hit.normal = Eigen::Vector3d(-(zu + zuv * hit_v) / cell_, -(zv + zuv * hit_u) / cell_, 1).normalized();
  hit.reflectivity = 0.2;
}

}  // namespace scanlock
