// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/radix_sort.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kMostEntries = std::size_t{1} << 31;
constexpr double kMostCells = 1048575.0;  // along each axis

/// The key of the neighbour at (0, dy, dz) of the cube `centre`: the middle cube of a row of three along x.
std::uint64_t row_about(std::uint64_t centre, int dy, int dz) {
  return centre + static_cast<std::uint64_t>(dz * (std::int64_t{1} << 42) + dy * (std::int64_t{1} << 21));
}

}  // namespace

NeighbourFinder::NeighbourFinder(const PointCloud& cloud, float radius)
    : cloud_(cloud),
      squared_radius_(radius * radius),
      side_(static_cast<double>(radius * 1.0001f)),  // rounding must not carry a neighbour two cubes away
      low_(Eigen::Array3d::Constant(std::numeric_limits<double>::infinity())) {
  if (!(radius > 0)) throw std::invalid_argument("NeighbourFinder: the radius must be above 0");
  std::vector<KeyedIndex> sorted;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.point(i).allFinite()) low_ = low_.min(cloud.point(i).cast<double>().array());
  }
  sorted.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.point(i).allFinite()) sorted.emplace_back(key(cloud.point(i)), static_cast<std::uint32_t>(i));
  }
  radix_sort(&sorted);
  keys_.reserve(sorted.size());
  order_.reserve(sorted.size());
  for (const auto& [cube, index] : sorted) {
    keys_.push_back(cube);
    order_.push_back(index);
  }
}

/// The key of the cube of p. Coordinates start at 1, so that keys of neighbouring cubes do not wrap around,
/// and no key is 0.
std::uint64_t NeighbourFinder::key(const Eigen::Vector3f& p) const {
  const Eigen::Array3d cell = ((p.cast<double>().array() - low_) / side_).floor().min(kMostCells);
  const auto part = [](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v) + 1); };
  return part(cell.z()) << 42 | part(cell.y()) << 21 | part(cell.x());
}

std::size_t NeighbourFinder::first_from(std::uint64_t key) const {
  return static_cast<std::size_t>(std::lower_bound(keys_.begin(), keys_.end(), key) - keys_.begin());
}

void NeighbourFinder::gather_about(const Eigen::Vector3f& p) {
  const std::uint64_t cube = key(p);
  if (cube != gathered_) gather(cube);
}

/// Gathers the points in the 27 cubes around `centre`.
void NeighbourFinder::gather(std::uint64_t centre) {
  std::vector<std::uint32_t>& index = candidates_.index;
  index.clear();
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      const std::uint64_t row = row_about(centre, dy, dz);
      for (std::size_t k = first_from(row - 1); k < keys_.size() && keys_[k] <= row + 1; ++k)
        index.push_back(order_[k]);
    }
  }
  std::sort(index.begin(), index.end());
  Candidates& c = candidates_;
  for (std::vector<float>* v : {&c.x, &c.y, &c.z, &c.squared}) v->resize(index.size());
  for (std::size_t k = 0; k < index.size(); ++k) {
    c.x[k] = cloud_.x[index[k]];
    c.y[k] = cloud_.y[index[k]];
    c.z[k] = cloud_.z[index[k]];
  }
  gathered_ = centre;
}

void NeighbourFinder::measure(const Eigen::Vector3f& p) {
  Candidates& c = candidates_;
  const float px = p.x(), py = p.y(), pz = p.z();
  for (std::size_t k = 0; k < c.index.size(); ++k) {
    const float dx = c.x[k] - px, dy = c.y[k] - py, dz = c.z[k] - pz;
    c.squared[k] = dx * dx + dy * dy + dz * dz;
  }
}

const NeighbourFinder::Neighbours& NeighbourFinder::about(std::size_t i) {
  const Eigen::Vector3f p = cloud_.point(i);
  std::size_t found = 0;
  if (p.allFinite()) {
    gather_about(p);
    measure(p);
    // Written without a branch: each candidate is stored, and the next one overwrites it if it is too far.
    // Half of them are, in no predictable order.
    neighbours_.index.resize(candidates_.index.size());
    neighbours_.squared_distance.resize(candidates_.index.size());
    for (std::size_t k = 0; k < candidates_.index.size(); ++k) {
      neighbours_.index[found] = candidates_.index[k];
      neighbours_.squared_distance[found] = candidates_.squared[k];
      found += candidates_.squared[k] <= squared_radius_ ? 1 : 0;
    }
  }
  neighbours_.index.resize(found);
  neighbours_.squared_distance.resize(found);
  return neighbours_;
}

/// Starts with the row of cubes of the point itself, in which most points have enough neighbours.
bool NeighbourFinder::has_more_than(std::size_t count, std::size_t i) const {
  const Eigen::Vector3f p = cloud_.point(i);
  if (!p.allFinite()) return false;
  const std::uint64_t centre = key(p);
  std::size_t found = 0;
  for (const int dz : {0, -1, 1}) {
    for (const int dy : {0, -1, 1}) {
      const std::uint64_t row = row_about(centre, dy, dz);
      for (std::size_t k = first_from(row - 1); k < keys_.size() && keys_[k] <= row + 1; ++k) {
        found += (cloud_.point(order_[k]) - p).squaredNorm() <= squared_radius_ ? 1 : 0;
        if (found > count) return true;
      }
    }
  }
  return false;
}

NeighbourLists radius_neighbours(const PointCloud& cloud, float radius) {
  NeighbourFinder finder(cloud, radius);
  // Neighbours are found in the order of the cubes, and stored in the order of the points.
  NeighbourLists lists;
  lists.begin.resize(cloud.size() + 1, 0);
  std::size_t entries = 0;
  for (std::uint32_t i : finder.order()) {
    const std::size_t count = finder.about(i).count();
    lists.begin[i + 1] = static_cast<std::uint32_t>(count);
    entries += count;
    if (entries > kMostEntries)
      throw std::length_error(
          "radius_neighbours: too many neighbours; thin the cloud or take a smaller radius");
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) lists.begin[i + 1] += lists.begin[i];
  lists.index.resize(entries);
  lists.squared_distance.resize(entries);
  for (std::uint32_t i : finder.order()) {
    const NeighbourFinder::Neighbours& found = finder.about(i);
    const auto at = static_cast<std::ptrdiff_t>(lists.begin[i]);
    std::copy(found.index.begin(), found.index.end(), lists.index.begin() + at);
    std::copy(found.squared_distance.begin(), found.squared_distance.end(),
              lists.squared_distance.begin() + at);
  }
  return lists;
}

}  // namespace scanlock
