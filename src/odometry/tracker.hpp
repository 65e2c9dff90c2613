// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/local_map.hpp"
#include "odometry/odometer.hpp"
#include "odometry/recovery.hpp"
#include "odometry/tracked_scan.hpp"
#include "odometry/tracker_config.hpp"

namespace scanlock {

/// The parts of the work on one scan, for whoever measures them: the tracker itself owns no clock.
enum class Stage : std::int8_t { kPreprocess = 0, kAlign = 1, kMap = 2 };

/// What other sensors say of a scan; each is optional, and ignored where it contradicts the scans.
struct ScanPrior {
  std::optional<Pose> motion;  ///< body at the scan before -> body now: last_from_now, from odometry
  std::optional<Eigen::Quaterniond> level_from_body;  ///< attitude at the stamp; its heading is not used
};

/// LiDAR odometry over a sliding map of keyframes.
/// A pure function of its state and the scan: no clock, no thread that outlives a call, no randomness; the
/// result does not depend on `threads`. Not to be called from two threads at once.
class Tracker {
 public:
  explicit Tracker(const TrackerConfig& config);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// Never throws for any content of the scan; points that are not finite are skipped.
  TrackedScan track(const Scan& scan, const ScanPrior& prior = {});

  /// The search that the tracker would like to have done now, if any. Where and when it is done is the
  /// caller's choice: at once in a replay, in another thread in a robot; `give` its answer between two scans.
  /// One is out at a time.
  std::optional<RecoveryRequest> take_request();
  void give(RecoveryAnswer answer);
  /// To be told with the next scan: see TrackedScan::map_fault.
  void note_map_fault(const std::string& fault);

  /// Called at the end of each stage of `track`, for timing.
  void set_stage_observer(std::function<void(Stage)> observer);

  /// Forgets the map and the motion; the next scan is the first of a new epoch.
  void reset();

  /// The robot stands there, says somebody who knows: a new epoch, in the same map where there is one.
  void set_pose(const Pose& map_from_body);

  /// What a later run needs to come back to this map.
  SavedMap save() const;
  /// Forgets all, and looks for its place in a saved map with the scans to come; a new epoch. `fixed`: see
  /// KeyframeArchive::restore.
  void load(SavedMap saved, bool fixed = false);

  /// The map as it stands: points with normals, in the map frame.
  PointCloud map() const;

  // ---- for who ties its keyframes to each other: poses are in the tracker's own frame

  const KeyframeArchive& archive() const;
  const Pose& map_from_own() const;
  /// Of the frame that never jumps: see TrackedScan.
  Pose map_from_local() const;
  /// The sensor at the last scan.
  const Pose& own_from_body() const;
  /// What scans are aligned with.
  const LocalMap& local_map() const;
  /// Scans that a robot which is not sure of its place has followed, one after the other; 0 where it is sure.
  int excursion_scans() const;
  /// Counts the submaps: a robot that is lost, and finds no place, goes on in one of its own. Keyframes of
  /// others are kSubmapsApart from it at least; how they really lie to each other is not known.
  std::uint32_t submap() const;
  /// Metres along -x that keyframes of all others were moved when the last one began.
  double moved_away() const;
  /// It goes on in another submap, whose poses are told in another frame.
  void set_map_from_own(const Pose& map_from_own);
  /// Whether the last scan was aligned with the map that the archive is of.
  bool on_known_ground() const;
  /// Archived keyframes from there on, their utime, may be part of what scans are aligned with.
  std::int64_t local_map_utime() const;
  bool planar() const;
  double voxel() const;  ///< metres, of the map
  Odometer::Usual usual() const;
  /// Where the keyframes and the frame are really. `drift`: covariance of the map around the robot against
  /// the map frame, in the frame of own_from_body(). `jumps`: poses in the map frame jump by it.
  void correct(const std::map<std::uint32_t, Pose>& own_from_keyframe, const Pose& map_from_own,
               const Matrix6& drift, bool jumps);
  /// See KeyframeArchive::replace.
  void replace(std::uint32_t gone, std::uint32_t kept);
  void set_drift(const Matrix6& drift);
  const Matrix6& drift() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scanlock
