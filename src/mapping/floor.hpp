// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

#include "mapping/solid_cloud.hpp"

namespace scanlock {

/// A cell of a horizontal grid: x and y divided by its size, rounded down.
using Cell = std::pair<int, int>;
Cell cell_of(const Eigen::Vector3f& p, float size);

inline constexpr float kFloorCell = 0.5F;  ///< metres
/// Metres: largest step between cells of one floor, as a kerb or a ramp has.
inline constexpr float kFloorStep = 0.4F;

/// A cell of a surface that has 1.5 m of headroom above it.
struct FloorPlace {
  Cell cell;    ///< of size kFloorCell
  float z = 0;  ///< metres
  bool operator<(const FloorPlace& other) const { return std::tie(cell, z) < std::tie(other.cell, other.z); }
  Eigen::Vector3f middle() const {
    return {(static_cast<float>(cell.first) + 0.5F) * kFloorCell,
            (static_cast<float>(cell.second) + 0.5F) * kFloorCell, z};
  }
};

struct Floors {
  std::vector<FloorPlace> places;  ///< ordered by cells, then by heights
  /// Cells under a ceiling whose surface is 0.2 to 2 m above the flat floor around them, and cells of
  /// ceilings that are as far below the flat ceiling around them: furniture stands on the floor, and hangs
  /// from the ceiling where the cloud is upside down.
  std::size_t standing = 0, hanging = 0;
  /// Pairs of neighbouring cells between which the lower side of the cloud has a step and its upper side has
  /// none, and the other way round. Under an open sky the ground is the smoother side, whichever way up the
  /// cloud is.
  std::size_t rough_below = 0, rough_above = 0;
  bool open = false;  ///< most cells hold no two surfaces with 1.5 m of headroom between them
};

/// The z axis is up.
Floors find_floors(const SolidCloud& solid);

/// The places of wide floors, in their order. A floor is a connected set of places with small steps between
/// neighbours; it is wide if it has 1 m2 and a twentieth of the cells of the largest floor.
std::vector<FloorPlace> wide_floors(const std::vector<FloorPlace>& floor);

}  // namespace scanlock
