// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

Eigen::Vector3d direction(double azimuth, double elevation) {
  return {cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation)};
}

/// Appends elevations in radians, evenly spaced in degrees.
void append_rings(std::vector<double>& rings, double from_deg, double to_deg, int count) {
  for (int i = 0; i < count; ++i)
    rings.push_back((from_deg + (to_deg - from_deg) * i / std::max(1, count - 1)) * kPi / 180);
}

/// A spinning head: all lasers of a column fire together; it starts at the rear and turns clockwise, seen
/// from above.
std::vector<Beam> spin(const std::vector<double>& rings, int columns, double period) {
  std::vector<Beam> beams;
  beams.reserve(rings.size() * static_cast<std::size_t>(columns));
  for (int column = 0; column < columns; ++column) {
    const double turned = static_cast<double>(column) / columns;
    for (const double elevation : rings)
      beams.push_back({static_cast<float>(turned * period), direction(kPi * (1 - 2 * turned), elevation)});
  }
  return beams;
}

/// A pattern that never repeats and covers the field of view evenly over any time: the ratio of nods to turns
/// has the fractional part of the golden ratio. (With a pattern that nearly repeats, scan matching locks:
/// each scan fits the lines of the scan before it, turned by a small angle.)
std::vector<Beam> rosette(std::int64_t scan, int count, double period) {
  constexpr double kTurnsPerSecond = 83.717, kNodsPerSecond = 14.618034 * kTurnsPerSecond;
  constexpr double kLowest = -7, kHighest = 52;
  std::vector<Beam> beams;
  beams.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double since = period * i / count, t = static_cast<double>(scan) * period + since;
    const double nod = std::abs(2 * (kNodsPerSecond * t - std::floor(kNodsPerSecond * t)) - 1);
    const double turns = kTurnsPerSecond * t - std::floor(kTurnsPerSecond * t);
    beams.push_back({static_cast<float>(since),
                     direction(2 * kPi * turns, (kLowest + (kHighest - kLowest) * nod) * kPi / 180)});
  }
  return beams;
}

}  // namespace

LidarKind parse_lidar(const std::string& name) {
  constexpr std::pair<const char*, LidarKind> kNames[] = {{"vlp16", LidarKind::kVlp16},
                                                          {"hdl64", LidarKind::kHdl64},
                                                          {"os1-64", LidarKind::kOs1_64},
                                                          {"mid360", LidarKind::kMid360},
                                                          {"planar", LidarKind::kPlanar}};
  for (const auto& [known, kind] : kNames)
    if (name == known) return kind;
  throw std::invalid_argument("unknown lidar '" + name + "': choose vlp16, hdl64, os1-64, mid360 or planar");
}

LidarModel LidarModel::of(LidarKind kind) {
  LidarModel model;
  model.kind = kind;
  if (kind == LidarKind::kHdl64) {
    model.min_range = 0.9;
    model.max_range = 120;
  } else if (kind == LidarKind::kMid360) {
    model.min_range = 0.1;
    model.max_range = 60;
  } else if (kind == LidarKind::kPlanar) {
    model.min_range = 0.1;
    model.max_range = 30;
  }
  return model;
}

std::vector<Beam> LidarModel::sweep(std::int64_t scan) const {
  std::vector<double> rings;
  switch (kind) {
    case LidarKind::kVlp16:
      append_rings(rings, -15, 15, 16);
      return spin(rings, 1800 / column_step, period_s);
    case LidarKind::kHdl64:  // two blocks of 32 lasers, the lower block with coarser spacing
      append_rings(rings, -24.8, -8.83, 32);
      append_rings(rings, -8.33, 2, 32);
      return spin(rings, 2000 / column_step, period_s);
    case LidarKind::kOs1_64:
      append_rings(rings, -22.5, 22.5, 64);
      return spin(rings, 1024 / column_step, period_s);
    case LidarKind::kMid360:
      return rosette(scan, 20000, period_s);
    case LidarKind::kPlanar:
      append_rings(rings, 0, 0, 1);
      return spin(rings, 360 / column_step, period_s);
  }
  throw std::invalid_argument("unknown kind of lidar");
}

double LidarModel::loss(double range, double cosine, double reflectivity) const {
  const double grazing = 0.95 * exp(-cosine / 0.03);
  const double far = range / max_range;
  const double faint = std::min(0.95, 0.15 * far * far * far * far / std::max(0.05, reflectivity));
  return 1 - (1 - dropout) * (1 - grazing) * (1 - faint);
}

}  // namespace scanlock
