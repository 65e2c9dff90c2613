// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// For every point of a cloud all points within a radius, itself included, ascending by index: what
/// descriptors need, and what a tree is slow at, since the radius is the same for all.
struct NeighbourLists {
  std::vector<std::uint32_t> begin, end;  ///< list of point i: entries [begin[i], end[i])
  std::vector<std::uint32_t> index;       ///< into the cloud
  std::vector<float> squared_distance;    ///< metres squared

  std::size_t count(std::size_t i) const { return end[i] - begin[i]; }
};

/// `radius` in metres, > 0. Points that are not finite have empty lists and are in none. Throws
/// std::length_error when the lists would hold more than 2^31 entries.
NeighbourLists radius_neighbours(const PointCloud& cloud, float radius);

}  // namespace scanlock
