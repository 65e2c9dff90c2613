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
#include "odometry/odometer.hpp"
#include "odometry/recovery.hpp"
#include "odometry/tracked_scan.hpp"
#include "odometry/tracker_config.hpp"

namespace scanlock {

/// The stages of the work on one scan, for timing by the caller: the tracker itself owns no clock.
enum class Stage : std::int8_t { kPreprocess = 0, kAlign = 1, kMap = 2 };

/// Measurements of other sensors at a scan; each is optional.
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

  /// The search for the robot's pose that is due, if any. The caller performs it, at once in a replay, in
  /// another thread on a robot, and passes the answer to `give` between two scans. No other search is due
  /// before that.
  std::optional<RecoveryRequest> take_request();
  void give(RecoveryAnswer answer);
  /// Reports `fault` with the next scan: see TrackedScan::map_fault.
  void note_map_fault(const std::string& fault);

  /// Called at the end of each stage of `track`, for timing.
  void set_stage_observer(std::function<void(Stage)> observer);

  /// Forgets the map and the motion; the next scan is the first of a new epoch.
  void reset();

  /// Sets the pose, known to a user or another program: a new epoch, in the same map where there is one.
  void set_pose(const Pose& map_from_body);

  /// The map, for relocalisation in a later run.
  SavedMap save() const;
  /// Forgets the state, and searches a saved map for the pose of the scans that follow; begins a new epoch.
  /// `fixed`: see KeyframeArchive::restore.
  void load(SavedMap saved, bool fixed = false);

  /// The points of the local map, in the map frame.
  PointCloud map() const;

  // ---- for Mapper, which adds constraints: poses are in the tracker's own frame

  const KeyframeArchive& archive() const;
  const Pose& map_from_own() const;
  /// The transform from the local frame, which never jumps: see TrackedScan.
  Pose map_from_local() const;
  /// The pose of the sensor at the last scan.
  const Pose& own_from_body() const;
  /// The odometer of the active submap: scans are aligned with its map.
  const Odometer& odometer() const;
  /// Number of scans that lost-mode odometry has followed in a row; 0 where it does not run.
  int lost_odometry_scans() const;
  /// Index of the active submap, from 0: a robot that is lost for long begins a new one. Keyframes of other
  /// submaps are placed at least kSubmapsApart from it, because their true relative poses are not known.
  std::uint32_t submap() const;
  /// Metres along -x by which all earlier keyframes were moved when the active submap began.
  double moved_away() const;
  /// Sets the map frame, for a robot that has been localised in another submap, with a map frame of its own.
  void set_map_from_own(const Pose& map_from_own);
  /// Whether the last scan was aligned with the map of the active submap.
  bool on_known_ground() const;
  /// Archived keyframes of this utime or later are of this visit, and may be part of the local map: earlier
  /// keyframes are in it only where they are fixed, or where it was reloaded with them.
  std::int64_t local_map_utime() const;
  double voxel() const;  ///< metres, of the map
  /// Sets corrected poses of keyframes and of the map frame. `drift`: covariance of the map around the robot
  /// relative to the map frame, in the frame of own_from_body(). `jumps`: poses in the map frame jump by the
  /// correction, so that a new epoch begins.
  void correct(const std::map<std::uint32_t, Pose>& own_from_keyframe, const Pose& map_from_own,
               const Matrix6& drift, bool jumps);
  /// See KeyframeArchive::replace.
  void replace(std::uint32_t gone, std::uint32_t kept);
  void set_drift(const Matrix6& drift);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scanlock
