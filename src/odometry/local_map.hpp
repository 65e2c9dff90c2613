// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "icp/scan_alignment.hpp"
#include "odometry/voxel_index.hpp"

namespace scanlock {

/// One of the scans that the map is made of.
struct Keyframe {
  std::uint32_t id = 0;
  std::int64_t utime = 0;
  Pose map_from_body = Pose::Identity();
  PointCloud points;                   ///< deskewed and thinned, body frame
  std::optional<std::uint32_t> given;  ///< its id in a given map, which is right: see LocalMap::found_on()
};

struct LocalMapLimits {
  int max_keyframes = 60;
  int max_points = 200000;
  double max_distance = 100;  ///< metres from the robot at which a keyframe is forgotten
};

/// A sliding window of keyframes and their union, thinned to one point a voxel: the first point seen there
/// (so that the map does not drift with the scans aligned with it), for as long as a keyframe of the window
/// sees that voxel. Where a keyframe of a given map shows a voxel, its point stands there instead, so that
/// the robot's own keyframes only show what the given map does not. Coordinates are floats relative to
/// `origin()`, which follows the robot; axes are those of the map frame.
class LocalMap {
 public:
  explicit LocalMap(const LocalMapLimits& limits);
  LocalMap(const LocalMap&) = delete;  // the surfaces point into cloud and tree
  LocalMap& operator=(const LocalMap&) = delete;

  /// Adds a keyframe at its pose. New points are indexed at once; old ones are forgotten, and all points
  /// indexed together, only now and then. `voxel` in metres. Returns the share of its points that show new
  /// ground (0 to 1).
  double insert(Keyframe keyframe, double voxel);
  /// Replaces all keyframes, as if these were inserted in this order, given ones first, but indexed once.
  /// Returns what the last insert() would. `voxel` in metres.
  double load(std::vector<Keyframe> keyframes, double voxel);
  /// Whether this keyframe of a given map is one of the map's, at this pose.
  bool has(std::uint32_t given, const Pose& map_from_body) const;
  /// The given keyframes of the map become these; those that it has() need no points. They do not count as
  /// keyframes for the limits, but those too far away are forgotten. `voxel` in metres.
  void found_on(std::vector<Keyframe> given, double voxel);
  /// Whether it is founded on keyframes of a given map.
  bool is_founded() const { return !keyframes_.empty() && keyframes_.front().given; }
  /// Whether scans are of a planar sensor from now on: surfaces are then vertical.
  void set_planar(bool planar);
  bool planar() const { return planar_; }
  void clear();

  bool empty() const { return keyframes_.empty(); }
  const std::deque<Keyframe>& keyframes() const { return keyframes_; }
  std::size_t size() const { return cloud_.size(); }
  /// All points and where they were seen from, relative to origin().
  const PointCloud& cloud() const { return cloud_; }

  /// The origin of the coordinates, map frame.
  const Eigen::Vector3d& origin() const { return origin_; }
  /// The target of an alignment; coordinates relative to origin(). Valid until the next insert.
  AlignmentTarget target() { return {cloud_, tree_, surfaces_}; }
  /// The points within `radius` metres (horizontally) of `centre` (map frame), relative to it.
  PointCloud around(const Eigen::Vector3d& centre, double radius) const;
  /// All points in the map frame, with normals where surfaces were fitted.
  PointCloud snapshot() const;

 private:
  bool wants_rebuild(const Eigen::Vector3d& here, double voxel) const;
  void forget(const Eigen::Vector3d& here, const LocalMapLimits& limits);
  void move_origin(const Eigen::Vector3d& here);
  void note_voxels(double voxel);
  void note_ground();
  void index_all();
  std::size_t add_novel_points(const Keyframe& keyframe);
  template <typename Out>
  void drop(const Out& out);
  /// visit(index, point relative to origin(), key of its voxel).
  template <typename Visit>
  void each_point(const Keyframe& keyframe, const Visit& visit) const;
  void forget_points();
  std::vector<Keyframe> taken_out();

  LocalMapLimits limits_;
  std::deque<Keyframe> keyframes_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  PointCloud cloud_;                      ///< relative to origin_
  std::vector<std::uint32_t> last_seen_;  ///< by which keyframe, its id, each point
  std::vector<std::uint32_t> shown_;      ///< points of given keyframes in the voxel of each point
  bool planar_ = false;
  double voxel_ = 0;  ///< metres, of the grid that `taken_` is of
  VoxelIndex taken_;
  VoxelIndex ground_;  ///< the keyframe, its id, that first saw each cell of the size of a surface
  KdForest tree_;
  LocalSurfaces surfaces_;
  std::uint32_t next_id_ = 0;
};

}  // namespace scanlock
