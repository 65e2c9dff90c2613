// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/seen_space.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "global/cloud_normals.hpp"

namespace scanlock {
namespace {

constexpr float kCell = 1.5f;   // voxels
constexpr float kStandOff = 2;  // cells: the end of a ray may graze the surface that it ends on
constexpr int kSectors = 8;     // of the half circle, because a line has no sign
constexpr int kAcross = 2;      // sectors on either side of a normal, whose rays do not graze the surface
constexpr float kSteep = 0.5f;  // least horizontal part of a normal with a heading
// Rays are not traced outside of this box about the origin, which bounds the memory: 55 MB.
constexpr int kMostAside = 450, kMostAloft = 30;  // cells

int sector(const Eigen::Vector3f& direction) {
  const double turn = atan2(static_cast<double>(direction.y()), static_cast<double>(direction.x())) / kPi;
  return static_cast<int>(std::floor((turn + 1) * kSectors)) % kSectors;
}

std::uint8_t bit(int sector) {
  return static_cast<std::uint8_t>(1u << ((sector + kSectors) % kSectors));
}

std::uint8_t sectors_across(const Eigen::Vector3f& normal) {
  if (normal.head<2>().norm() < kSteep) return 0xff;
  std::uint8_t result = 0;
  const int middle = sector(normal);
  for (int k = -kAcross; k <= kAcross; ++k) result |= bit(middle + k);
  return result;
}

}  // namespace

SeenSpace::SeenSpace(const PointCloud& cloud, float voxel) : cell_size_(kCell * voxel) {
  Eigen::Array3i high = Eigen::Array3i::Zero();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (const Eigen::Vector3f& p : {cloud.point(i), cloud.eye(i)}) {
      low_ = low_.min(cell(p));
      high = high.max(cell(p));
    }
  }
  const Eigen::Array3i most(kMostAside, kMostAside, kMostAloft);
  low_ = low_.max(-most);
  size_ = high.min(most) - low_ + 1;
  headings_.assign(static_cast<std::size_t>(size_.cast<std::ptrdiff_t>().prod()), 0);
  surface_.assign(headings_.size(), false);
  mark_surfaces(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) trace_ray(cloud.eye(i), cloud.point(i));
  mark_tops(cloud);
}

Eigen::Array3i SeenSpace::cell(const Eigen::Vector3f& p) const {
  constexpr float kFar = kMostAside + 1;
  return (p.array() / cell_size_).floor().max(-kFar).min(kFar).cast<int>();
}

std::ptrdiff_t SeenSpace::index(const Eigen::Array3i& cell) const {
  const Eigen::Array3i offset = cell - low_;
  if ((offset < 0).any() || (offset >= size_).any()) return -1;
  return (static_cast<std::ptrdiff_t>(offset.z()) * size_.y() + offset.y()) * size_.x() + offset.x();
}

std::ptrdiff_t SeenSpace::column(const Eigen::Array3i& cell) const {
  return index({cell.x(), cell.y(), low_.z()});
}

void SeenSpace::mark_surfaces(const PointCloud& cloud) {
  const float half = 0.5f * cell_size_;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (std::abs(cloud.nz[i]) >= kLevel) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3f aside((corner & 1) != 0 ? half : -half, (corner & 2) != 0 ? half : -half,
                                  (corner & 4) != 0 ? half : -half);
      const std::ptrdiff_t at = index(cell(cloud.point(i) + aside));
      if (at >= 0) surface_[static_cast<std::size_t>(at)] = true;
    }
  }
}

void SeenSpace::mark_tops(const PointCloud& cloud) {
  top_.assign(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()), -1);
  auto heading = headings_.begin();
  for (int layer = 0; layer < size_.z(); ++layer) {
    for (int& top : top_) top = *heading++ != 0 ? layer : top;
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Array3i at = cell(cloud.point(i));
    if (index(at) < 0) continue;
    int& top = top_[static_cast<std::size_t>(column(at))];
    top = std::max(top, at.z() - low_.z());
  }
}

void SeenSpace::trace_ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  const float cells = (to - from).norm() / cell_size_;
  if (!(cells > kStandOff)) return;
  const Eigen::Vector3f step = (to - from) / cells;
  const std::uint8_t heading = bit(sector(step));
  const int steps = static_cast<int>(std::min(cells - kStandOff, 2.0f * kMostAside));
  for (int k = 1; k < steps; ++k) {
    const std::ptrdiff_t at = index(cell(from + static_cast<float>(k) * step));
    if (at >= 0) headings_[static_cast<std::size_t>(at)] |= heading;
  }
}

std::uint8_t SeenSpace::headings(const Eigen::Vector3f& p) const {
  const std::ptrdiff_t at = index(cell(p));
  return at >= 0 ? headings_[static_cast<std::size_t>(at)] : std::uint8_t{0};
}

bool SeenSpace::has_surface(const Eigen::Vector3f& p) const {
  const std::ptrdiff_t at = index(cell(p));
  return at >= 0 && surface_[static_cast<std::size_t>(at)];
}

bool SeenSpace::is_above(const Eigen::Vector3f& p) const {
  const Eigen::Array3i at = cell(p);
  const std::ptrdiff_t c = column(at);
  const int top = c >= 0 ? top_[static_cast<std::size_t>(c)] : -1;
  return top >= 0 && at.z() - low_.z() > top;
}

/// Rays pass closely above the ground between the few points where they hit it. Cells without rays in the
/// cell below are therefore taken for ground, and not for crossed.
bool SeenSpace::is_crossed(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const {
  const std::uint8_t here = headings(p);
  const std::uint8_t below = here != 0 ? headings(p - Eigen::Vector3f(0, 0, cell_size_)) : std::uint8_t{0};
  if (below == 0) return false;
  const std::uint8_t across = sectors_across(normal);
  return (here & across) != 0 && (below & across) != 0;
}

}  // namespace scanlock
