// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/shapes.hpp"
#include "simulation/terrain.hpp"

namespace scanlock {

/// All static parts of a world: the ground and the shapes on it. Ray casting traverses the terrain's
/// horizontal grid, whose cells list the shapes that extend over them.
class Scene {
 public:
  Scene() = default;
  explicit Scene(Terrain terrain) : terrain_(std::move(terrain)) {}

  void add(const Box& box) { boxes_.push_back(box); }
  void add(const Cylinder& cylinder) { cylinders_.push_back(cylinder); }
  void add(const Ellipsoid& ellipsoid) { ellipsoids_.push_back(ellipsoid); }
  void set_ceiling(double height) { ceiling_ = height; }
  /// Sorts the shapes into the grid. Call it once, after the last add() and before the first cast(). Parts
  /// outside the terrain's rectangle are not hit.
  void build();

  /// The first surface along the ray; not found when there is none within `max_range`. `seed` determines how
  /// deep the ray penetrates foliage.
  Hit cast(const Ray& ray, double max_range, std::uint64_t seed) const;

  const Terrain& terrain() const { return terrain_; }
  const std::vector<Box>& boxes() const { return boxes_; }
  const std::vector<Cylinder>& cylinders() const { return cylinders_; }
  const std::vector<Ellipsoid>& ellipsoids() const { return ellipsoids_; }
  std::optional<double> ceiling() const { return ceiling_; }

  /// Random bits for one ray and one ellipsoid.
  static std::uint64_t leaf_bits(std::uint64_t seed, std::uint64_t ellipsoid);

 private:
  enum class Kind : std::uint32_t { kBox, kCylinder, kEllipsoid };
  struct Item {
    Kind kind;
    std::uint32_t index;
    float lowest, highest;  // range of heights of the shape
  };
  struct Cell {
    std::uint32_t begin = 0, end = 0;  // of items_
    float lowest = 0, highest = 0;     // range of heights of the cell's content
  };
  void intersect_cell(int column, int row, const Ray& ray, double enter, double leave, std::uint64_t seed,
                      Hit& hit) const;

  Terrain terrain_;
  std::optional<double> ceiling_;
  std::vector<Box> boxes_;
  std::vector<Cylinder> cylinders_;
  std::vector<Ellipsoid> ellipsoids_;
  std::vector<Cell> cells_;
  std::vector<Item> items_;
};

/// The point of the ground at the horizontal position p.
inline Eigen::Vector3d on_ground(const Scene& scene, const Eigen::Vector2d& p) {
  return {p.x(), p.y(), scene.terrain().height(p.x(), p.y())};
}

/// Replaces `hit` when the ray hits a horizontal ceiling at a shorter range.
void intersect_ceiling(double height, const Ray& ray, Hit& hit);

}  // namespace scanlock
