// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace scanlock {
namespace {

constexpr std::size_t kMostEntries = std::size_t{1} << 31;
constexpr double kMostCells = 1048575.0;  // a side
constexpr std::size_t kUsualNeighbours = 64;

/// Points sorted into cubes with the radius as their side, x fastest: the neighbours of all points of a cube
/// are in nine runs of this order.
class CubeOrder {
 public:
  CubeOrder(const PointCloud& cloud, float side) {
    Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (cloud.point(i).allFinite()) low = low.min(cloud.point(i).cast<double>().array());
    }
    order_.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.point(i).allFinite()) continue;
      const Eigen::Array3d cell =
          ((cloud.point(i).cast<double>().array() - low) / static_cast<double>(side)).floor().min(kMostCells);
      order_.push_back({key(static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
                            static_cast<std::int64_t>(cell.z())),
                        static_cast<std::uint32_t>(i)});
    }
    std::sort(order_.begin(), order_.end());
  }

  struct Entry {
    std::uint64_t key;
    std::uint32_t index;
    bool operator<(const Entry& other) const {
      return key != other.key ? key < other.key : index < other.index;
    }
  };
  const std::vector<Entry>& order() const { return order_; }

  /// The indices of all points in the 27 cubes about the one of `key`, ascending.
  void gather(std::uint64_t centre, std::vector<std::uint32_t>* indices) const {
    indices->clear();
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const std::uint64_t row =
            centre + static_cast<std::uint64_t>(static_cast<std::int64_t>(dz) * (std::int64_t{1} << 42) +
                                                static_cast<std::int64_t>(dy) * (std::int64_t{1} << 21));
        auto at = std::lower_bound(order_.begin(), order_.end(), Entry{row - 1, 0});
        for (; at != order_.end() && at->key <= row + 1; ++at) indices->push_back(at->index);
      }
    }
    std::sort(indices->begin(), indices->end());
  }

 private:
  /// One off in each coordinate, so that the cubes about the first are no wrap.
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>((z + 1) << 42 | (y + 1) << 21 | (x + 1));
  }
  std::vector<Entry> order_;
};

/// The points about a cube, copied together.
struct Candidates {
  std::vector<std::uint32_t> index;
  std::vector<float> x, y, z, squared;
  std::vector<std::uint32_t> near;
  std::vector<float> near_squared;

  void load(const PointCloud& cloud) {
    for (std::vector<float>* v : {&x, &y, &z, &squared, &near_squared}) v->resize(index.size());
    near.resize(index.size());
    for (std::size_t k = 0; k < index.size(); ++k) {
      x[k] = cloud.x[index[k]];
      y[k] = cloud.y[index[k]];
      z[k] = cloud.z[index[k]];
    }
  }
  void measure(const Eigen::Vector3f& p) {
    const float px = p.x(), py = p.y(), pz = p.z();
    for (std::size_t k = 0; k < index.size(); ++k) {
      const float dx = x[k] - px, dy = y[k] - py, dz = z[k] - pz;
      squared[k] = dx * dx + dy * dy + dz * dz;
    }
  }
  void append_within(float squared_radius, NeighbourLists* lists) {
    // All are written, and those too far away written over: which they are cannot be foretold, so a branch
    // would cost more.
    std::size_t count = 0;
    for (std::size_t k = 0; k < index.size(); ++k) {
      near[count] = index[k];
      near_squared[count] = squared[k];
      count += squared[k] <= squared_radius ? 1 : 0;
    }
    const auto end = static_cast<std::ptrdiff_t>(count);
    lists->index.insert(lists->index.end(), near.begin(), near.begin() + end);
    lists->squared_distance.insert(lists->squared_distance.end(), near_squared.begin(),
                                   near_squared.begin() + end);
  }
};

}  // namespace

NeighbourLists radius_neighbours(const PointCloud& cloud, float radius) {
  if (!(radius > 0)) throw std::invalid_argument("radius_neighbours: the radius must be above 0");
  const CubeOrder cubes(cloud, radius * 1.0001f);  // rounding must not carry a neighbour two cubes away
  const auto& order = cubes.order();
  const float squared_radius = radius * radius;
  NeighbourLists lists;
  lists.begin.resize(cloud.size(), 0);
  lists.end.resize(cloud.size(), 0);
  lists.index.reserve(kUsualNeighbours * cloud.size());
  lists.squared_distance.reserve(kUsualNeighbours * cloud.size());
  Candidates candidates;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last < order.size() && order[last].key == order[first].key) ++last;
    cubes.gather(order[first].key, &candidates.index);
    candidates.load(cloud);
    for (; first < last; ++first) {
      const std::uint32_t i = order[first].index;
      lists.begin[i] = static_cast<std::uint32_t>(lists.index.size());
      candidates.measure(cloud.point(i));
      candidates.append_within(squared_radius, &lists);
      lists.end[i] = static_cast<std::uint32_t>(lists.index.size());
    }
    if (lists.index.size() > kMostEntries)
      throw std::length_error(
          "radius_neighbours: too many neighbours; thin the cloud or take a smaller radius");
  }
  return lists;
}

}  // namespace scanlock
