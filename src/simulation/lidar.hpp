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

/// One laser pulse. The beams of a scan are in the order of their times.
struct Beam {
  float time;                 ///< seconds since the start of the sweep
  Eigen::Vector3d direction;  ///< of length 1, in the sensor's frame
};

/// A sensor as described by its data sheet. Lengths in metres.
struct LidarModel {
  LidarKind kind = LidarKind::kVlp16;
  double period_s = 0.1;
  double min_range = 0.5, max_range = 100;
  double noise = 0.02;     ///< standard deviation of a range
  double quantum = 0.002;  ///< ranges are integer multiples of it
  double dropout = 0.01;   ///< probability that a good return is lost at random
  int column_step = 1;     ///< of a spinning sensor: only every so many-th column fires

  static LidarModel of(LidarKind kind);

  /// The beams of sweep number `scan`; the same in every sweep, except for the mid360.
  std::vector<Beam> sweep(std::int64_t scan) const;
  bool repeats() const { return kind != LidarKind::kMid360; }

  /// Probability that a surface gives no return: higher at long range, at grazing incidence, and for low
  /// reflectivity.
  double loss(double range, double cosine, double reflectivity) const;
};

}  // namespace scanlock
