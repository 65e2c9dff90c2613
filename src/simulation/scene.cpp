// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/scene.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/random.hpp"

namespace scanlock {
namespace {

/// Traversal of the grid along one axis.
struct Walk {
  int cell, step;
  double next;   // range at which the ray leaves the cell along this axis
  double delta;  // range from one cell border to the next
};

Walk start_walk(double origin, double direction, double low, double size, int count, double enter) {
  Walk walk;
  const double position = (origin + enter * direction - low) / size;
  walk.cell = std::clamp(static_cast<int>(std::floor(position)), 0, count - 1);
  walk.step = direction > 0 ? 1 : -1;
  if (std::abs(direction) < 1e-12) {
    walk.next = walk.delta = HUGE_VAL;
    return walk;
  }
  const double border = low + size * (walk.cell + (direction > 0 ? 1 : 0));
  walk.next = (border - origin) / direction;
  walk.delta = size / std::abs(direction);
  return walk;
}

/// Narrows [enter, leave] to the part of the ray between low and high; false when it is empty.
bool clip(double origin, double direction, double low, double high, double& enter, double& leave) {
  if (std::abs(direction) < 1e-12) return origin >= low && origin < high;
  const double a = (low - origin) / direction, b = (high - origin) / direction;
  enter = std::max(enter, std::min(a, b));
  leave = std::min(leave, std::max(a, b));
  return enter < leave;
}

}  // namespace

void intersect_ceiling(double height, const Ray& ray, Hit& hit) {
  if (ray.direction.z() <= 0) return;
  const double range = (height - ray.origin.z()) / ray.direction.z();
  if (range <= 0 || range >= hit.range) return;
  hit.range = range;
  hit.found = true;
  hit.normal = -Eigen::Vector3d::UnitZ();
  hit.reflectivity = 0.6;
}

std::uint64_t Scene::leaf_bits(std::uint64_t seed, std::uint64_t ellipsoid) {
  return mix_bits(seed ^ mix_bits(ellipsoid + 0x9e3779b97f4a7c15ull));
}

void Scene::build() {
  const int columns = terrain_.columns(), rows = terrain_.rows();
  std::vector<std::vector<Item>> lists(static_cast<std::size_t>(columns * rows));
  cells_.assign(lists.size(), {});
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      cells_[row * columns + column].lowest = static_cast<float>(terrain_.lowest(column, row) - 1e-3);
      cells_[row * columns + column].highest = static_cast<float>(terrain_.highest(column, row) + 1e-3);
    }
  const auto enlist = [&](Kind kind, std::size_t index, const Bounds& bounds) {
    const auto cell_of = [&](double value, double low) {
      return static_cast<int>(std::floor((value - low) / terrain_.cell()));
    };
    const auto lowest = static_cast<float>(bounds.min().z() - 1e-3);
    const auto highest = static_cast<float>(bounds.max().z() + 1e-3);
    const int left = std::max(0, cell_of(bounds.min().x(), terrain_.low().x()));
    const int right = std::min(columns - 1, cell_of(bounds.max().x(), terrain_.low().x()));
    const int bottom = std::max(0, cell_of(bounds.min().y(), terrain_.low().y()));
    const int top = std::min(rows - 1, cell_of(bounds.max().y(), terrain_.low().y()));
    for (int row = bottom; row <= top; ++row)
      for (int column = left; column <= right; ++column) {
        Cell& cell = cells_[row * columns + column];
        lists[row * columns + column].push_back({kind, static_cast<std::uint32_t>(index), lowest, highest});
        cell.lowest = std::min(cell.lowest, lowest);
        cell.highest = std::max(cell.highest, highest);
      }
  };
  for (std::size_t i = 0; i < boxes_.size(); ++i) enlist(Kind::kBox, i, bounds_of(boxes_[i]));
  for (std::size_t i = 0; i < cylinders_.size(); ++i) enlist(Kind::kCylinder, i, bounds_of(cylinders_[i]));
  for (std::size_t i = 0; i < ellipsoids_.size(); ++i) enlist(Kind::kEllipsoid, i, bounds_of(ellipsoids_[i]));

  items_.clear();
  for (std::size_t i = 0; i < lists.size(); ++i) {
    cells_[i].begin = static_cast<std::uint32_t>(items_.size());
    items_.insert(items_.end(), lists[i].begin(), lists[i].end());
    cells_[i].end = static_cast<std::uint32_t>(items_.size());
  }
}

void Scene::intersect_cell(int column, int row, const Ray& ray, double enter, double leave,
                           std::uint64_t seed, Hit& hit) const {
  const Cell& cell = cells_[row * terrain_.columns() + column];
  const double z_enter = ray.origin.z() + enter * ray.direction.z();
  const double z_leave = ray.origin.z() + leave * ray.direction.z();
  const auto lower = static_cast<float>(std::min(z_enter, z_leave));
  const auto upper = static_cast<float>(std::max(z_enter, z_leave));
  if (lower > cell.highest || upper < cell.lowest) return;
  terrain_.intersect_cell(column, row, ray, enter, leave, hit);
  for (std::uint32_t i = cell.begin; i < cell.end; ++i) {
    const Item& item = items_[i];
    if (lower > item.highest || upper < item.lowest) continue;
    if (item.kind == Kind::kBox) {
      intersect(boxes_[item.index], ray, hit);
    } else if (item.kind == Kind::kCylinder) {
      intersect(cylinders_[item.index], ray, hit);
    } else {
      intersect(ellipsoids_[item.index], ray, leaf_bits(seed, item.index), hit);
    }
  }
}

Hit Scene::cast(const Ray& ray, double max_range, std::uint64_t seed) const {
  Hit hit;
  hit.range = max_range;
  if (ceiling_) intersect_ceiling(*ceiling_, ray, hit);

  double enter = 0, leave = hit.range;
  const Eigen::Vector2d low = terrain_.low(), high = terrain_.high();
  if (!clip(ray.origin.x(), ray.direction.x(), low.x(), high.x(), enter, leave)) return hit;
  if (!clip(ray.origin.y(), ray.direction.y(), low.y(), high.y(), enter, leave)) return hit;
  const double size = terrain_.cell();
  Walk x = start_walk(ray.origin.x(), ray.direction.x(), low.x(), size, terrain_.columns(), enter);
  Walk y = start_walk(ray.origin.y(), ray.direction.y(), low.y(), size, terrain_.rows(), enter);
  while (enter < leave) {
    const double next = std::min({x.next, y.next, leave});
    intersect_cell(x.cell, y.cell, ray, enter, next, seed, hit);
    if (hit.range <= next) break;  // cells farther away cannot contain a nearer hit
    if (x.next < y.next) {
      x.cell += x.step;
      x.next += x.delta;
    } else {
      y.cell += y.step;
      y.next += y.delta;
    }
    if (x.cell < 0 || y.cell < 0 || x.cell >= terrain_.columns() || y.cell >= terrain_.rows()) break;
    enter = next;
  }
  return hit;
}

}  // namespace scanlock
