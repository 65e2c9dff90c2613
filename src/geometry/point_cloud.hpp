// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanlock {

/// Points as a structure of arrays, so that the compiler can vectorise loops over one coordinate.
/// x, y, z always have the same size; every other array is either empty or of that size too.
struct PointCloud {
  std::vector<float> x, y, z;               ///< metres, in the frame that the owner of the cloud documents
  std::vector<float> nx, ny, nz;            ///< unit normals
  std::vector<float> intensity;             ///< in the unit of the sensor
  std::vector<float> time;                  ///< seconds relative to the stamp of the scan; may be negative
  std::vector<Eigen::Vector3f> viewpoints;  ///< metres: sensor origin from which the point was measured
  std::vector<std::uint8_t> alone;          ///< 1: point of an isolated object, see odometry/standing_alone

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  bool has_normals() const { return !x.empty() && nx.size() == x.size(); }
  bool has_intensity() const { return !x.empty() && intensity.size() == x.size(); }
  bool has_times() const { return !x.empty() && time.size() == x.size(); }
  bool is_alone(std::size_t i) const { return !alone.empty() && alone[i] != 0; }
  bool has_viewpoints() const { return !x.empty() && viewpoints.size() == x.size(); }

  Eigen::Vector3f point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Eigen::Vector3f normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
  /// Sensor origin of point i, metres; the origin of the frame for clouds without `eyes`.
  Eigen::Vector3f eye(std::size_t i) const {
    return has_viewpoints() ? viewpoints[i] : Eigen::Vector3f::Zero();
  }

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
/// `utime` is the instant, in microseconds, that the pose of this scan refers to; `points.time` is relative
/// to it.
struct Scan {
  std::int64_t utime = 0;
  PointCloud points;
  bool stamped_by_arrival = false;  ///< the sender gave no stamp: utime is the time of arrival
};

}  // namespace scanlock
