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

// Lengths as shares of the reach of a keyframe (see ArchivedKeyframe):
inline constexpr double kPlaceSpacing = 1.0 / 6.0;     ///< least distance between keyframes of one minute
inline constexpr double kKeyframeVoxel = 1.0 / 100.0;  ///< least voxel to which a keyframe is thinned
inline constexpr double kSameSpot = 1.0 / 3.0;         ///< keyframes nearer than this cover the same ground

/// A keyframe that is kept for relocalisation: a pose, and the points that were seen from it.
struct ArchivedKeyframe {
  std::int64_t utime = 0;                 ///< microseconds, stamp of the scan
  Pose map_from_body = Pose::Identity();  ///< body: the sensor at the stamp
  float reach = 0;                        ///< metres, median range of the scan: the size of the scene
  KeyframePoints points = {};             ///< x y z only, deskewed and thinned, body frame
  /// Body-up attitudes observed near this keyframe: z axes of the body, unit, axes of the map, at least 0.05
  /// rad apart.
  std::vector<Eigen::Vector3f> body_ups = {};
  std::uint32_t id = 0;  ///< counted from 1, in the order of addition
  /// From an earlier keyframe to this one, by odometry or, after a relocalisation, by the alignment there;
  /// none for the first keyframe.
  std::optional<Constraint> constraint = std::nullopt;
  std::shared_ptr<const PlaceSignature> signature = nullptr;  ///< never null in an archive
};

/// The constraint from an archived keyframe to a pose whose keyframe has no id yet. `covariance`: right
/// perturbation, [metres; radians].
Constraint constraint_to(const ArchivedKeyframe& before, const Pose& map_from_here,
                         const Matrix6& covariance);

/// Metres along x between submaps whose relative pose is unknown: more than a robot drives before the oldest
/// keyframes of its archive are evicted.
inline constexpr double kSubmapsApart = 2e4;

inline constexpr std::size_t kMostBodyUps = 32;  ///< body-up attitudes per keyframe

/// The state that outlives a run: the content of a map file.
struct SavedMap {
  std::uint32_t epoch = 0;
  Pose last_pose = Pose::Identity();        ///< map_from_body of the last trusted scan
  std::vector<ArchivedKeyframe> keyframes;  ///< oldest first
  /// Between keyframes, whose ids are positions in the list, counted from 1; 0 is the map frame. Empty: the
  /// map is rigid.
  std::vector<Constraint> constraints = {};
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< in the map frame
};

/// The same map in another frame; the points are shared, and constraints are unchanged.
SavedMap moved(const SavedMap& map, const Pose& there_from_here);

/// Keyframes spread over all mapped ground, for relocalisation. A cap on the number of points bounds its
/// cost. Copies are cheap: they share the points.
class KeyframeArchive {
 public:
  /// `max_points`: cap over all keyframes that were not restored; the oldest of these are evicted.
  explicit KeyframeArchive(std::size_t max_points) : max_points_(max_points) {}

  /// True where no keyframe of the last minute is within a sixth of `reach` (metres) of `position` (map
  /// frame). `utime`: microseconds, now.
  bool wants(std::int64_t utime, const Eigen::Vector3d& position, double reach) const;
  /// Whether a position (map frame) is within reach of a keyframe.
  bool knows(const Eigen::Vector3d& position) const;
  /// The size of the scene around a position (map frame): the mean reach, metres, of the keyframes near it.
  /// Precondition: not empty.
  double scene(const Eigen::Vector3d& position) const;
  /// Adds a keyframe; its points are thinned. `utime`: microseconds; `reach`: metres, median range of the
  /// scan; `points`: body frame, any density; `tie`: from an archived keyframe, see constraint_to().
  void add(std::int64_t utime, const Pose& map_from_body, double reach, const PointCloud& points,
           const std::optional<Constraint>& constraint = std::nullopt);
  /// Adds the body-up attitude to the nearest keyframe: on slopes it differs between nearby positions.
  void note_body_up(const Pose& map_from_body);
  /// Replaces all keyframes by those of a saved map, which are never evicted and do not count for the cap.
  /// Their ids are positions in the list, counted from 1; each gets a nearly rigid constraint to the one
  /// before. `fixed`: they are not to be moved or replaced, either. Returns why the stored points of a
  /// keyframe cannot be read, if any cannot (see PointsUnreadable), otherwise an empty string; such a
  /// keyframe has an empty signature, which is similar to none.
  std::string restore(std::vector<ArchivedKeyframe> keyframes, bool fixed = false);
  bool is_fixed(std::uint32_t id) const { return fixed_ && id <= restored_; }
  /// The number of fixed keyframes, which come first.
  std::size_t fixed() const { return fixed_ ? first_of_own() : 0; }
  /// Removes the keyframe `gone`; its body-up attitudes are added to `kept`. Precondition: both ids exist.
  void replace(std::uint32_t gone, std::uint32_t kept);
  /// Sets new poses, by id.
  void move(const std::map<std::uint32_t, Pose>& map_from_body);
  /// Appends the keyframes of another submap. Earlier keyframes are moved along -x by the number of metres
  /// that it returns, so that all are at least kSubmapsApart from the new ones.
  double begin_submap(const KeyframeArchive& seen);
  void clear();
  /// A copy without the keyframes whose ids are in `nodes` and, if `without_fixed`, without the fixed ones.
  KeyframeArchive without(const std::map<std::uint32_t, Pose>& nodes, bool without_fixed) const;

  const std::vector<ArchivedKeyframe>& keyframes() const { return keyframes_; }
  bool empty() const { return keyframes_.empty(); }
  /// The keyframe with that id; null if it was evicted or replaced.
  const ArchivedKeyframe* find(std::uint32_t id) const;
  /// The keyframe nearest to a position (map frame). Precondition: not empty.
  const ArchivedKeyframe& nearest(const Eigen::Vector3d& position) const {
    return keyframes_[nearest_index(position)];
  }
  /// Number of points that count for the cap.
  std::size_t points() const { return points_; }

 private:
  std::size_t nearest_index(const Eigen::Vector3d& position) const;
  void append(ArchivedKeyframe keyframe);
  std::size_t first_of_own() const;
  void count_points();
  void evict();

  std::uint32_t next_id_ = 1;
  std::uint32_t restored_ = 0;  ///< largest id of the restored keyframes; 0: none
  bool fixed_ = false;          ///< whether the restored keyframes are fixed
  std::size_t max_points_, points_ = 0;
  std::vector<ArchivedKeyframe> keyframes_;
};

/// The different body-up attitudes observed within `radius` metres of `centre` (map frame): z axes of the
/// body, unit, axes of the map.
std::vector<Eigen::Vector3d> body_ups_around(const std::vector<ArchivedKeyframe>& keyframes,
                                             const Eigen::Vector3d& centre, double radius);

/// The keyframes that may have points within `radius` metres (horizontally) of `centre` (map frame): those
/// within `radius` plus four times their reach.
std::vector<const ArchivedKeyframe*> keyframes_seeing(const std::vector<ArchivedKeyframe>& keyframes,
                                                      const Eigen::Vector3d& centre, double radius);

/// The points of all keyframes within `radius` metres (horizontally) of `centre` (map frame), with their
/// sensor origins, thinned to `voxel` metres: axes of the map, coordinates relative to `centre`. Throws
/// PointsUnreadable.
PointCloud submap_around(const std::vector<ArchivedKeyframe>& keyframes, const Eigen::Vector3d& centre,
                         double radius, double voxel);

}  // namespace scanlock
