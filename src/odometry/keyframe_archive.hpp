// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "odometry/constraint.hpp"
#include "odometry/keyframe_points.hpp"
#include "odometry/place_signature.hpp"

namespace scanlock {

inline constexpr double kPlaceSpacing = 1.0 / 6.0;     ///< of the reach, between two keyframes of one way
inline constexpr double kKeyframeVoxel = 1.0 / 100.0;  ///< of the reach: a keyframe is thinned to it, or more
inline constexpr double kSameSpot = 1.0 / 3.0;  ///< of the reach: keyframes so near show the same ground

/// A keyframe that is kept for relocalisation: a pose, and the points that were seen from there.
struct ArchivedKeyframe {
  std::int64_t utime = 0;                 ///< microseconds, stamp of the scan
  Pose map_from_body = Pose::Identity();  ///< body: the sensor at the stamp
  float reach = 0;                        ///< metres, median range of the scan: the size of the scene
  KeyframePoints points = {};             ///< x y z only, deskewed and thinned, body frame
  /// The ways in which the body stood about here: its z axis, axes of the map, some degrees apart.
  std::vector<Eigen::Vector3f> stands = {};
  std::uint32_t id = 0;  ///< from 1 on, in the order in which they were added
  /// From an earlier one to here, by odometry; none of the first one.
  std::optional<Constraint> tie = std::nullopt;
  std::shared_ptr<const PlaceSignature> signature = nullptr;  ///< never null in an archive
};

/// From a keyframe that was archived before to a pose, whose keyframe has no id yet. `covariance`: right
/// perturbation, [metres; radians].
Constraint tie_to(const ArchivedKeyframe& before, const Pose& map_from_here, const Matrix6& covariance);

/// Metres along x between submaps, as long as nobody knows how they lie to each other: farther than a robot
/// drives before its archive has forgotten where it came from.
inline constexpr double kSubmapsApart = 2e4;

inline constexpr std::size_t kMostStands = 32;  ///< of a place

/// Everything that outlives a run: what a map file holds.
struct SavedMap {
  std::uint32_t epoch = 0;
  Pose last_pose = Pose::Identity();        ///< map_from_body of the last scan that was tracked
  std::vector<ArchivedKeyframe> keyframes;  ///< oldest first
  /// Between keyframes, by their places in the list, from 1 on; 0 is the map's frame. None: it is rigid.
  std::vector<Constraint> constraints = {};
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< in the map's frame
};

/// The same map in another frame; the points are shared, and constraints stay as they are.
SavedMap moved(const SavedMap& map, const Pose& there_from_here);

/// The long memory: keyframes spread over all mapped ground, for coming back to. What it costs is bounded by
/// its cap. Copies are cheap: they share the points.
class KeyframeArchive {
 public:
  /// `max_points`: over all keyframes that were not restored; the oldest of these give way.
  explicit KeyframeArchive(std::size_t max_points) : max_points_(max_points) {}

  /// True where no keyframe of the last minute is within a sixth of `reach` (metres) of `position` (map
  /// frame).
  bool wants(std::int64_t utime, const Eigen::Vector3d& position, double reach) const;
  /// Whether the robot has seen this position from near.
  bool knows(const Eigen::Vector3d& position) const;
  /// The size of the scene around a position: the mean reach, metres, of the places there. Not of an empty
  /// one.
  double scene(const Eigen::Vector3d& position) const;
  /// `points` in the body frame, any density.
  void add(std::int64_t utime, const Pose& map_from_body, double reach, const PointCloud& points,
           const std::optional<Constraint>& tie = std::nullopt);
  /// The body stood like this: on slopes that differs from one step to the next.
  void note_stand(const Pose& map_from_body);
  /// What was saved: it never gives way, and does not count for the cap. Ids are places in the list, from 1
  /// on; each is tied to the one before, rigidly. `fixed`: nothing moves or replaces it either. Returns why
  /// stored points cannot be read, where some cannot (see PointsUnreadable): nothing looks like what they
  /// show.
  std::string restore(std::vector<ArchivedKeyframe> keyframes, bool fixed = false);
  bool is_fixed(std::uint32_t id) const { return fixed_ && id <= restored_; }
  /// The number of those keyframes, which come first.
  std::size_t fixed() const { return fixed_ ? first_of_own() : 0; }
  /// The keyframe `gone` leaves; how the body stood there is noted where it is `kept`. Both have to be there.
  void replace(std::uint32_t gone, std::uint32_t kept);
  /// New poses, by id.
  void move(const std::map<std::uint32_t, Pose>& map_from_body);
  /// These are of another submap. Those that are there already are moved away along x, by as many metres as
  /// it returns, so that all are kSubmapsApart from the new one at least.
  double begin_submap(const KeyframeArchive& seen);
  void clear();
  /// Those of its keyframes that are not nodes, nor fixed where those are left out, too.
  KeyframeArchive without(const std::map<std::uint32_t, Pose>& nodes, bool without_fixed) const;

  const std::vector<ArchivedKeyframe>& keyframes() const { return keyframes_; }
  bool empty() const { return keyframes_.empty(); }
  /// The keyframe with that id; null where it has given way.
  const ArchivedKeyframe* find(std::uint32_t id) const;
  /// Not of an empty one.
  const ArchivedKeyframe& nearest(const Eigen::Vector3d& position) const {
    return keyframes_[nearest_index(position)];
  }
  std::size_t points() const { return points_; }

 private:
  std::size_t nearest_index(const Eigen::Vector3d& position) const;
  void append(ArchivedKeyframe keyframe);
  std::size_t first_of_own() const;
  void count_points();
  void evict();

  std::uint32_t next_id_ = 1;
  std::uint32_t restored_ = 0;  ///< ids up to there
  bool fixed_ = false;          ///< those are
  std::size_t max_points_, points_ = 0;
  std::vector<ArchivedKeyframe> keyframes_;
};

/// The different ways in which the body stood within `radius` metres of `centre` (map frame): directions of
/// its z axis, axes of the map.
std::vector<Eigen::Vector3d> stands_around(const std::vector<ArchivedKeyframe>& keyframes,
                                           const Eigen::Vector3d& centre, double radius);

/// Those that may have seen something within `radius` metres (horizontally) of `centre` (map frame).
std::vector<const ArchivedKeyframe*> keyframes_seeing(const std::vector<ArchivedKeyframe>& keyframes,
                                                      const Eigen::Vector3d& centre, double radius);

/// What was seen within `radius` metres (horizontally) of `centre` (map frame), and where from, thinned to
/// `voxel` metres: axes of the map, coordinates relative to `centre`.
PointCloud submap_around(const std::vector<ArchivedKeyframe>& keyframes, const Eigen::Vector3d& centre,
                         double radius, double voxel);

}  // namespace scanlock
