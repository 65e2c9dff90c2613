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

/// Of a horizontal grid: floor of x and y by its size.
using Cell = std::pair<int, int>;
Cell cell_of(const Eigen::Vector3f& p, float size);

inline constexpr float kFloorCell = 0.5F;  ///< metres
inline constexpr float kFloorStep = 0.4F;  ///< metres from one cell of a floor to the next: a kerb, a ramp

/// On what has 1.5 m of headroom above it there.
struct FloorPlace {
  Cell cell;    ///< of kFloorCell
  float z = 0;  ///< metres
  bool operator<(const FloorPlace& other) const { return std::tie(cell, z) < std::tie(other.cell, other.z); }
  Eigen::Vector3f middle() const {
    return {(static_cast<float>(cell.first) + 0.5F) * kFloorCell,
            (static_cast<float>(cell.second) + 0.5F) * kFloorCell, z};
  }
};

struct Floors {
  std::vector<FloorPlace> places;  ///< ordered by cells, then by heights
  /// Cells under a ceiling whose surface is 0.2 to 2 m above the flat floor around them, and those of
  /// ceilings as far below a flat ceiling: furniture stands on the floor, and hangs where up is down.
  std::size_t standing = 0, hanging = 0;
  /// Neighbouring cells between which the lower side of the cloud has a step and its upper side has none, and
  /// the other way round. Under an open sky the ground is the smoother side, whichever way up the cloud is.
  std::size_t rough_below = 0, rough_above = 0;
  bool open = false;  ///< most cells hold nothing that one could walk under
};

/// The z axis is up.
Floors find_floors(const SolidCloud& solid);

/// Of places that hang together by small steps, those of wide floors, in order.
std::vector<FloorPlace> wide_floors(const std::vector<FloorPlace>& floor);

}  // namespace scanlock
