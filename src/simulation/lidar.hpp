// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace scanlock {

enum class LidarKind : std::int8_t { kVlp16, kHdl64, kOs1_64, kMid360, kPlanar };

/// `vlp16`, `hdl64`, `os1-64`, `mid360` or `planar`; throws std::invalid_argument for any other name.
LidarKind parse_lidar(const std::string& name);

/// One shot of a laser. The beams of a scan are in the order of their times.
struct Beam {
  float time;                 ///< seconds since the sweep began
  Eigen::Vector3d direction;  ///< of length 1, in the sensor's frame
};

/// A sensor as its data sheet describes it. Lengths in metres.
struct LidarModel {
  LidarKind kind = LidarKind::kVlp16;
  double period_s = 0.1;
  double min_range = 0.5, max_range = 100;
  double noise = 0.02;     ///< standard deviation of a range
  double quantum = 0.002;  ///< ranges are whole multiples of it
  double dropout = 0.01;   ///< share of good returns that go missing at random

  static LidarModel of(LidarKind kind);

  /// The beams of one sweep; for all but the mid360 the same in each.
  std::vector<Beam> sweep(std::int64_t scan) const;
  bool repeats() const { return kind != LidarKind::kMid360; }

  /// The chance that a surface gives no return: more far away, at grazing incidence, and from dark matter.
  double loss(double range, double cosine, double reflectivity) const;
};

}  // namespace scanlock
