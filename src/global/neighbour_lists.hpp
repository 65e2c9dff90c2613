// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Finds all points within a fixed radius of a point, by a grid of cubes: faster than a tree, and without the
/// memory of NeighbourLists. Keeps a reference to the cloud, whose coordinates must not change.
class NeighbourFinder {
 public:
  /// The neighbours of a point, ascending by index.
  struct Neighbours {
    std::vector<std::uint32_t> index;     ///< into the cloud
    std::vector<float> squared_distance;  ///< metres squared
    std::size_t count() const { return index.size(); }
  };

  /// `radius` in metres, > 0; throws std::invalid_argument otherwise.
  NeighbourFinder(const PointCloud& cloud, float radius);

  /// The neighbours of point i, itself included; none for a point that is not finite. Valid until the next
  /// call.
  const Neighbours& about(std::size_t i);
  /// Whether point i has more than `count` neighbours; faster than about().
  bool has_more_than(std::size_t count, std::size_t i) const;
  /// The indices of the finite points, in the order in which a loop over about() is fastest.
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  /// The points in the 27 cubes around a point (nine runs of three), ascending by index.
  struct Candidates {
    std::vector<std::uint32_t> index;
    std::vector<float> x, y, z, squared;
  };
  std::uint64_t key(const Eigen::Vector3f& p) const;
  std::size_t first_from(std::uint64_t key) const;
  void gather_about(const Eigen::Vector3f& p);
  void gather(std::uint64_t centre);
  void measure(const Eigen::Vector3f& p);

  const PointCloud& cloud_;
  float squared_radius_;
  double side_;  ///< metres, of a cube
  Eigen::Array3d low_;
  std::vector<std::uint64_t> keys_;   ///< of the cubes of the points, ascending; x fastest
  std::vector<std::uint32_t> order_;  ///< the points in the order of their cubes
  std::uint64_t gathered_ = 0;        ///< the key of the cube that the candidates were gathered around
  Candidates candidates_;
  Neighbours neighbours_;
};

/// For every point of a cloud all points within a radius, itself included, ascending by index. For small
/// radii, as the memory is proportional to the number of neighbours.
struct NeighbourLists {
  std::vector<std::uint32_t> begin;     ///< list of point i: entries [begin[i], begin[i + 1])
  std::vector<std::uint32_t> index;     ///< into the cloud
  std::vector<float> squared_distance;  ///< metres squared

  std::size_t count(std::size_t i) const { return begin[i + 1] - begin[i]; }
};

/// `radius` in metres, > 0. Points that are not finite have empty lists and are in no other list. Throws
/// std::length_error when the lists would have more than 2^31 entries.
NeighbourLists radius_neighbours(const PointCloud& cloud, float radius);

}  // namespace scanlock
