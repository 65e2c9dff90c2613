// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>

#include "daemon/background_search.hpp"
#include "daemon/config.hpp"
#include "daemon/intake.hpp"
#include "daemon/map_store.hpp"
#include "daemon/publisher_watch.hpp"
#include "daemon/statistics.hpp"
#include "geometry/moved_cloud.hpp"
#include "mapping/cloud_map.hpp"
#include "mapping/mapper.hpp"
#include "messages/reports.hpp"
#include "odometry/prior_judge.hpp"

namespace scanlock {

/// A scan that the pipeline is done with, on its way out.
struct FinishedScan {
  TrackedScan tracked;  ///< already seen from the body
  std::int32_t scan_seq = 0;
  std::int64_t recv_utime = 0;  ///< microseconds, see ReceivedScan
  std::chrono::steady_clock::time_point arrival;
  StageTimes times;  ///< total_ms is filled in at the publishing
};

/// The middle stage of the pipeline, between Intake and Outputs: tracks scans and does between two of them
/// what is commanded. Live, searches run beside it; in a replay at once, so that what comes out depends on
/// the scans and commands alone. For one thread.
class Pipeline {
 public:
  enum class Mode : std::int8_t { kLive, kReplay };

  /// Loads the configured map. Throws std::runtime_error with a sentence when that is damaged.
  Pipeline(const Config& config, Statistics& statistics, Mode mode);

  FinishedScan process(const ReceivedScan& received);
  /// What came of it is counted, and explained where it was rejected.
  void execute(const Command& command);
  /// Saves the map in the background when that is due.
  void save_map_when_due();
  /// At the end: saves the configured map. Throws std::runtime_error with a sentence when that fails.
  void finish();

  /// In the frame of the poses that it tells.
  PointCloud map() const { return moved(mapper_.map(), body_from_sensor_); }

  enum class Part : std::int8_t {
    kAll,    ///< the submap that the robot is in, and those before it
    kFirst,  ///< the map that was given, and what has become one with it since
  };
  /// What is archived, likewise; thinned to `voxel` metres.
  PointCloud archived(float voxel, Part part) const;

  /// For trajectories that are written at the end: see Mapper.
  void keep_history() { mapper_.keep_history(); }
  /// What leads from a pose of the body as it was told to where the map puts it now.
  Pose correction(std::uint32_t stamp) const;

 private:
  void track(const ReceivedScan& received, FinishedScan* finished);
  TrackedScan track_with_prior(const ReceivedScan& received);
  void note_clock(const TrackedScan& tracked);
  void attempt(const Command& command);

  const Mode mode_;
  const Pose body_from_sensor_;
  Statistics& statistics_;
  MapStore maps_;
  Mapper mapper_;
  PriorJudge judge_;
  PublisherWatch publishers_;
  BackgroundSearch search_;
};

}  // namespace scanlock
