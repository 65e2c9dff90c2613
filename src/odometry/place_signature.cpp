// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/place_signature.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kNearest = 1.0;  // metres: inner radius of the rings, whose widths grow with the range
constexpr float kAbove = 0.5F;    // metres above the sensor, from which on a point counts as above it
constexpr float kHighest = 0.3F;  // of the range: no sensor sees much higher
constexpr double kBeside = 0.6;   // each cell has at least this share of the value of each neighbour

}  // namespace

PlaceSignature::PlaceSignature(const PointCloud& points, const Eigen::Matrix3f& level) {
  std::array<double, kCells> counts{}, wide{};
  if (!count(points, level, true, &counts)) count(points, level, false, &counts);
  for (double& cell : counts) cell = std::sqrt(cell);
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    const std::size_t before = (sector + kSectors - 1) % kSectors, after = (sector + 1) % kSectors;
    for (std::size_t ring = 0; ring < kRings; ++ring) {
      double beside = std::max(counts[before * kRings + ring], counts[after * kRings + ring]);
      if (ring > 0) beside = std::max(beside, counts[sector * kRings + ring - 1]);
      if (ring + 1 < kRings) beside = std::max(beside, counts[sector * kRings + ring + 1]);
      wide[sector * kRings + ring] = std::max(counts[sector * kRings + ring], kBeside * beside);
    }
  }
  cells_.reserve(static_cast<std::size_t>(
      std::count_if(wide.begin(), wide.end(), [](double value) { return value > 0; })));
  double sum = 0;
  for (std::size_t i = 0; i < kCells; ++i) {
    if (!(wide[i] > 0)) continue;
    const auto value = static_cast<std::int16_t>(std::lround(std::min(16 * wide[i], 1000.0)));
    cells_.push_back({static_cast<std::uint8_t>(i % kRings), static_cast<std::uint8_t>(i / kRings), value});
    sum += static_cast<double>(value) * value;
  }
  norm_ = std::sqrt(sum);
}

/// Adds the points to the cells of `counts`; false where none counts. `high`: only points above the sensor.
bool PlaceSignature::count(const PointCloud& points, const Eigen::Matrix3f& level, bool high,
                           std::array<double, kCells>* counts) {
  const double rings = static_cast<double>(kRings) / log(kReach / kNearest);
  bool any = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = level * points.point(i);
    const double range = static_cast<double>(p.head<2>().norm());
    if (!(range >= kNearest && range < kReach) || !std::isfinite(p.z())) continue;
    if (high && (p.z() < kAbove || p.z() > kHighest * static_cast<float>(range))) continue;
    const auto ring = static_cast<std::size_t>(rings * log(range / kNearest));
    const double turn = atan2(static_cast<double>(p.y()), static_cast<double>(p.x())) / (2 * kPi) + 0.5;
    const auto sector = static_cast<std::size_t>(turn * static_cast<double>(kSectors));
    (*counts)[std::min(sector, kSectors - 1) * kRings + std::min(ring, kRings - 1)] += 1;
    any = true;
  }
  return any;
}

double PlaceSignature::similarity(const PlaceSignature& other) const {
  if (!(norm_ > 0 && other.norm_ > 0)) return 0;
  std::array<std::array<std::int16_t, 2 * kSectors>, kRings> twice_around{};
  for (const Cell& cell : cells_)
    twice_around[cell.ring][cell.sector] = twice_around[cell.ring][cell.sector + kSectors] = cell.value;
  std::array<std::int32_t, kSectors> sums{};  // for each turn; integers, so that the order does not matter
  for (const Cell& cell : other.cells_) {
    const std::int16_t* ring = &twice_around[cell.ring][cell.sector];
    for (std::size_t turn = 0; turn < kSectors; ++turn)
      sums[turn] += static_cast<std::int32_t>(cell.value) * static_cast<std::int32_t>(ring[turn]);
  }
  return static_cast<double>(*std::max_element(sums.begin(), sums.end())) / (norm_ * other.norm_);
}

}  // namespace scanlock
