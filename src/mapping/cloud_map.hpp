// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "mapping/solid_cloud.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

struct CloudMapOptions {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< axes of the map
  double max_range_m = 120.0;                     ///< of the sensor that will look for its place there
  Pose map_from_cloud = Pose::Identity();
  int threads = 1;  ///< the map does not depend on it
};

/// A map out of a bare cloud, which may come from any program: keyframes at places where a robot can have
/// stood, of what it would have seen from there. They stand an eye's height above floors that are wide
/// enough, where nothing is in the way, so that every such place sees a keyframe near by. Nothing moves in
/// that map. The order of the points does not matter. Memory is taken for voxels of 0.1 m that hold points,
/// not for points.
class CloudMapBuilder {
 public:
  explicit CloudMapBuilder(const CloudMapOptions& options);
  /// Some of the cloud's points.
  void add(PointCloud part);
  /// Once, after all points. Throws std::runtime_error "NAME: what is wrong" for a cloud without such places.
  /// `progress`: floor done and floor in all, any unit.
  SavedMap build(const std::string& name,
                 const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});
  /// After that, a sentence where nothing stands on most of its floor: an open field, or a cloud
  /// that is upside down. Empty otherwise.
  const std::string& doubt() const { return doubt_; }

 private:
  CloudMapOptions options_;
  Eigen::Matrix3d level_;  ///< rotation; its z axis is up
  SolidCloud solid_;       ///< in the level frame
  std::uint64_t points_ = 0;
  std::string doubt_;
};

/// The same for a cloud as a whole.
SavedMap map_of_cloud(const PointCloud& cloud, const std::string& name, const CloudMapOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

/// What the keyframes saw, as one cloud in the map's frame, thinned to `voxel` metres.
PointCloud cloud_of_map(const SavedMap& map, float voxel);

}  // namespace scanlock
