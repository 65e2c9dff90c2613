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

/// One of the scans that a local map consists of.
struct Keyframe {
  std::uint32_t id = 0;    ///< set by LocalMap
  std::int64_t utime = 0;  ///< microseconds, stamp of the scan
  Pose map_from_body = Pose::Identity();
  PointCloud points;                   ///< deskewed and thinned, body frame, metres
  std::optional<std::uint32_t> given;  ///< its id in a given map, none for the robot's own keyframes
};

struct LocalMapLimits {
  int max_keyframes = 60;
  int max_points = 200000;
  double max_distance = 100;  ///< metres from the robot beyond which a keyframe is removed
};

/// A sliding window of keyframes and their union, thinned to one point per voxel: the first point measured
/// there (so that the map does not drift with the scans aligned with it), as long as a keyframe of the window
/// has a point in that voxel. In voxels that a keyframe of a given map covers, the point is from that
/// keyframe, so that the robot's own keyframes only add ground that the given map does not cover. Coordinates
/// are floats (metres) relative to `origin()`, which follows the robot; axes are those of the map frame.
class LocalMap {
 public:
  explicit LocalMap(const LocalMapLimits& limits);
  LocalMap(const LocalMap&) = delete;  // the surfaces point into cloud and tree
  LocalMap& operator=(const LocalMap&) = delete;

  /// Adds a keyframe at its pose. Its new points are indexed at once; only now and then old keyframes are
  /// removed and all points indexed together. `voxel` in metres. Returns the share of its points on new
  /// ground (0 to 1): in a cell of the size of a surface in which no earlier keyframe has a point.
  double insert(Keyframe keyframe, double voxel);
  /// Replaces all keyframes, as if these were inserted in this order, given ones first, but indexed once.
  /// Returns the result of the last insert(), 0 without keyframes. `voxel` in metres.
  double load(std::vector<Keyframe> keyframes, double voxel);
  /// Whether the map has the keyframe of a given map with this id, at exactly this pose.
  bool has(std::uint32_t given, const Pose& map_from_body) const;
  /// Replaces the given keyframes of the map; those that it has() already need no points. They do not count
  /// for max_keyframes, but are removed beyond max_distance. `voxel` in metres.
  void found_on(std::vector<Keyframe> given, double voxel);
  /// Whether the map contains keyframes of a given map.
  bool is_founded() const { return !keyframes_.empty() && keyframes_.front().given; }
  /// Whether scans are from a planar sensor from now on: surfaces are then vertical.
  void set_planar(bool planar);
  bool planar() const { return planar_; }
  void clear();

  bool empty() const { return keyframes_.empty(); }
  const std::deque<Keyframe>& keyframes() const { return keyframes_; }
  std::size_t size() const { return cloud_.size(); }
  /// All points and their sensor origins, relative to origin().
  const PointCloud& cloud() const { return cloud_; }

  /// The origin of the coordinates, map frame, metres.
  const Eigen::Vector3d& origin() const { return origin_; }
  /// The target of an alignment; coordinates relative to origin(). Valid until the map changes.
  AlignmentTarget target() { return {cloud_, tree_, surfaces_}; }
  /// The points within `radius` metres (horizontally) of `centre` (map frame), and their sensor origins,
  /// relative to `centre`; axes of the map frame.
  PointCloud around(const Eigen::Vector3d& centre, double radius) const;
  /// All points in the map frame.
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
  /// Calls visit(index, point relative to origin(), key of its voxel) for each point of a keyframe.
  template <typename Visit>
  void each_point(const Keyframe& keyframe, const Visit& visit) const;
  void forget_points();
  std::vector<Keyframe> taken_out();

  LocalMapLimits limits_;
  std::deque<Keyframe> keyframes_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  PointCloud cloud_;  ///< relative to origin_
  /// For each point: the id of the last own keyframe with a point in its voxel, or else of the given keyframe
  /// that added it.
  std::vector<std::uint32_t> last_trusted_;
  std::vector<std::uint32_t> shown_;  ///< for each point: number of points of given keyframes in its voxel
  bool planar_ = false;
  double voxel_ = 0;   ///< metres, of the grid of `taken_`
  VoxelIndex taken_;   ///< index in cloud_ of the point in each voxel
  VoxelIndex ground_;  ///< id of the first keyframe with a point in each cell of the size of a surface
  KdForest tree_;
  LocalSurfaces surfaces_;
  std::uint32_t next_id_ = 0;
};

}  // namespace scanlock
