// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanlock {

/// Points as a structure of arrays, so that loops over one coordinate vectorise.
/// x, y, z always have the same size; every other array is either empty or of that size too.
struct PointCloud {
  std::vector<float> x, y, z;         ///< metres, in the frame that the owner of the cloud names
  std::vector<float> nx, ny, nz;      ///< unit normals
  std::vector<float> intensity;       ///< as the sensor gives it
  std::vector<float> time;            ///< seconds relative to the stamp of the scan; may be negative
  std::vector<Eigen::Vector3f> eyes;  ///< metres: where the sensor stood that saw the point
  std::vector<std::uint8_t> alone;    ///< 1: seen in front of what is beside it, see odometry/standing_alone

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  bool has_normals() const { return !x.empty() && nx.size() == x.size(); }
  bool has_intensity() const { return !x.empty() && intensity.size() == x.size(); }
  bool has_times() const { return !x.empty() && time.size() == x.size(); }
  bool is_alone(std::size_t i) const { return !alone.empty() && alone[i] != 0; }
  bool has_eyes() const { return !x.empty() && eyes.size() == x.size(); }

  Eigen::Vector3f point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Eigen::Vector3f normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
  /// Where nothing else is said the sensor stood at the origin.
  Eigen::Vector3f eye(std::size_t i) const { return has_eyes() ? eyes[i] : Eigen::Vector3f::Zero(); }

  void reserve(std::size_t n) {
    x.reserve(n);
    y.reserve(n);
    z.reserve(n);
  }
  void push_back(float px, float py, float pz) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
  }
  void push_back(const Eigen::Vector3f& p) { push_back(p.x(), p.y(), p.z()); }
};

/// One revolution (or frame) of a sensor, in the sensor's frame: x forward, y left, z up.
/// `utime` is the instant, in microseconds, at which the pose of this scan shall hold;
/// `points.time` counts from it.
struct Scan {
  std::int64_t utime = 0;
  PointCloud points;
  bool stamped_by_arrival = false;  ///< its sender gave no stamp
};

}  // namespace scanlock
