// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "odometry/alignment_check.hpp"
#include "odometry/given_ground.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"
#include "odometry/relocalisation.hpp"
#include "odometry/scan_preparation.hpp"
#include "odometry/timeline.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// The state of a Tracker, and the processing of one scan.
struct Tracker::State {
  static constexpr double kDegradedShare = 0.4;  // inlier ratio: with a lower one a scan is DEGRADED

  TrackerConfig config;
  std::function<void(Stage)> observer;

  VoxelScale scale;
  std::unique_ptr<Odometer> odometer;
  KeyframeArchive archive;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // upward direction, own frame
  int attitudes = 0;                              // number of which `up` is the mean

  TrackingState state = TrackingState::kInitialising;
  std::uint32_t epoch = 0;
  double moved_away = 0;     // metres along -x by which earlier submaps were moved when the last one began
  std::uint32_t submap = 0;  // index of the active submap, from 0
  Timeline time;
  bool begun = false;  // a scan with enough points came in
  // All poses of the state are in the own frame, that of the first scan, so that the result does not depend
  // on the origin and heading of the map's frame. Inputs and outputs are transformed.
  Pose map_from_own = Pose::Identity();
  Pose local_from_own = Pose::Identity();
  bool jumped = false;           // the pose in the own frame jumped since the last keyframe was archived
  std::int64_t reloaded_at = 0;  // when the local map was reloaded from the archive; microseconds

  AlignmentCheck check;
  // At the last trusted scan the position along x or y was not known, as in a tunnel: a robot that is then
  // lost cannot be relocalised at one place. Where only the heading was unknown, behind a cover, it can.
  bool open = false;
  // When the active submap began with an open position: until it is joined its poses are as uncertain as that
  // position was. After new_map_after_s they are those of a new epoch.
  std::optional<std::int64_t> loose_since;
  std::string map_fault;  // to be reported with the next scan
  GivenGround given_ground;

  Relocalisation relocalisation;

  explicit State(const TrackerConfig& c)
      : config(c),
        scale(c.map_points_per_scan, c.min_voxel_m, c.max_voxel_m),
        odometer(std::make_unique<Odometer>(c)),
        archive(static_cast<std::size_t>(c.max_archive_points)),
        relocalisation(c) {}

  void finished(Stage stage) const {
    if (observer) observer(stage);
  }
  static Eigen::Vector3d up_in_body(const ScanPrior& auxiliary) {
    return auxiliary.level_from_body->conjugate() * Eigen::Vector3d::UnitZ();
  }

  // ---- tracking.cpp

  /// Crops and thins the scan; one with too few points is reported as empty.
  PreparedScan prepare(const Scan& scan, TrackedScan* tracked);
  /// The predicted state at this scan: by the velocity, or by the motion that another sensor measured.
  MotionPrior predict(const ScanPrior& auxiliary = {}) const;
  /// Updates the mean upward direction of the map with the attitude at a trusted scan.
  void note_attitude(const ScanPrior& auxiliary);
  /// The scan becomes the map.
  void start(const PreparedScan& scan);
  /// Aligns from the prediction. Where that does not explain the scan: once more with a loosened prior and
  /// the far reach.
  Attempt align_or_retry(const PreparedScan& scan, const MotionPrior& prior);
  /// Seconds since the last trusted scan.
  double unseen_s() const { return check.unseen_s(time.now()); }

  /// A scan of a robot that is not lost: predict, align, decide, fuse.
  void track_on(const PreparedScan& scan, const ScanPrior& auxiliary, TrackedScan* tracked);
  void trust(const PreparedScan& scan, const Attempt& attempt);
  /// From here on poses are in another frame, relative to which they are not uncertain.
  void begin_epoch();
  void keep(const PreparedScan& scan, double share);
  /// The constraint of a new keyframe: by odometry, to the keyframe before it; after a jump, by the alignment
  /// of this scan, to the nearest keyframe.
  std::optional<Constraint> constraint();
  /// The pose in the own frame changed otherwise than by motion: keeps the local frame free of jumps.
  void jump(const Pose& from, const Pose& to);
  /// The prediction stands in for a scan that is not trusted; after two such scans in a row the robot is
  /// lost.
  void distrust(const MotionPrior& prior, bool kidnapped = false);
  /// The prediction stands in for a scan without points.
  void coast(const MotionPrior& prior);

  // ---- tracking_lost.cpp

  /// A scan of a lost robot: followed by lost-mode odometry until it is relocalised, or begins a submap.
  void track_lost(const PreparedScan& scan, const ScanPrior& auxiliary, TrackedScan* tracked);
  /// The map of lost-mode odometry becomes the active submap. Where the position was open, the pose has not
  /// jumped, and stays as uncertain as before.
  void begin_submap(const PreparedScan& scan, TrackedScan* tracked);
  void lose() { relocalisation.begin(*odometer, check.last(), check.looks_alike(), archive); }

  /// Where `work` cannot read stored points, the local map stays as it is.
  template <typename Work>
  void read_map(const Work& work) {
    try {
      work();
    } catch (const PointsUnreadable& error) {
      map_fault = error.what();
    }
  }

  /// The local map becomes the archived keyframes around `centre`.
  void reload(const Eigen::Vector3d& centre);

  // ---- tracker.cpp

  void describe(const Attempt& attempt, PoseMethod method, TrackedScan* tracked) const;
  TrackingState reported_state() const { return relocalisation.lost() ? relocalisation.state() : state; }

  void report(TrackedScan* tracked);
};

}  // namespace scanlock
