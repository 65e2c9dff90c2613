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
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< upward direction, axes of the map
  double max_range_m = 120.0;                     ///< range of the sensor that will be relocalised in the map
  Pose map_from_cloud = Pose::Identity();
  int threads = 1;  ///< worker threads; the map does not depend on their number
};

/// A map made from a cloud without poses, of any program. Its keyframes stand at poses that a robot may take:
/// at a sensor's height above floors that are wide enough, in free space, and so densely that from every such
/// position the sensor of a keyframe nearby is visible. Each holds the points that are visible from its pose.
/// The cloud is static, and poses in the map are exact. The order of the points does not matter. Memory grows
/// with the number of voxels of 0.1 m that hold points, not with the number of points.
class CloudMapBuilder {
 public:
  explicit CloudMapBuilder(const CloudMapOptions& options);
  /// A part of the cloud's points.
  void add(PointCloud part);
  /// Call once, after all points. Throws std::runtime_error "NAME: reason" for a cloud without usable points
  /// or without such floors. `progress`: area of floor done and in total, any unit.
  SavedMap build(const std::string& name,
                 const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});
  /// After build(), one sentence each: how many points were left out, and why; that the cloud covers a larger
  /// area in a side view than in the top view; that under an open sky its upper side is smoother than its
  /// lower one; or that more cells hang from its ceilings than stand on its floors.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  CloudMapOptions options_;
  Eigen::Matrix3d level_;  ///< rotation from the map's axes to the level frame, whose z axis is up
  SolidCloud solid_;       ///< in the level frame
  std::uint64_t points_ = 0;
  std::optional<Eigen::Vector3f> first_finite_;  ///< the first finite point, in the cloud's frame
  std::vector<std::string> warnings_;
};

/// CloudMapBuilder for a cloud that is in memory as a whole.
SavedMap map_of_cloud(const PointCloud& cloud, const std::string& name, const CloudMapOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

/// The points of all keyframes as one cloud in the map's frame, thinned to `voxel` metres.
PointCloud cloud_of_map(const SavedMap& map, float voxel);

}  // namespace scanlock
