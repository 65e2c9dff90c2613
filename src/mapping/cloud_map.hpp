// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "mapping/solid_cloud.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

struct CloudMapOptions {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< axes of the map
  double max_range_m = 120.0;                     ///< of the sensor that will be relocalised there
  Pose map_from_cloud = Pose::Identity();
  int threads = 1;  ///< the map does not depend on it
};

/// A map of a cloud without poses, which may come from any program: keyframes at poses that a robot may have,
/// with the points that are visible from there. They stand at a sensor's height above floors that are wide
/// enough, in free space, so densely that every such position sees a keyframe nearby. The cloud is static:
/// poses of the map are exact. The order of the points does not matter. Memory is taken for voxels of 0.1 m
/// that hold points, not for points.
class CloudMapBuilder {
 public:
  explicit CloudMapBuilder(const CloudMapOptions& options);
  /// A part of the cloud's points.
  void add(PointCloud part);
  /// Call once, after all points. Throws std::runtime_error "NAME: what is wrong" for a cloud without such
  /// floors. `progress`: area of floor done and in all, any unit.
  SavedMap build(const std::string& name,
                 const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});
  /// After build(), each a sentence: how many points were left out, and why; that it covers more from a
  /// side than from above; that its upper side is smoother than its lower one, under an open sky; or that
  /// more hangs from its ceilings than stands on its floors.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  CloudMapOptions options_;
  Eigen::Matrix3d level_;  ///< rotation; its z axis is up
  SolidCloud solid_;       ///< in the level frame
  std::uint64_t points_ = 0;
  std::optional<Eigen::Vector3f> first_finite_;  ///< point, axes of the cloud
  std::vector<std::string> warnings_;
};

/// The same for a cloud as a whole.
SavedMap map_of_cloud(const PointCloud& cloud, const std::string& name, const CloudMapOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

/// The points of all keyframes as one cloud in the map's frame, thinned to `voxel` metres.
PointCloud cloud_of_map(const SavedMap& map, float voxel);

}  // namespace scanlock
