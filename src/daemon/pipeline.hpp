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
#include "odometry/consistency_check.hpp"

namespace scanlock {

/// A scan that the pipeline has finished, ready to be published.
struct FinishedScan {
  TrackedScan tracked;  ///< for the body, see seen_from_body()
  std::int32_t scan_seq = 0;
  std::int64_t recv_utime = 0;  ///< microseconds, see ReceivedScan
  std::chrono::steady_clock::time_point arrival;
  StageTimes times;  ///< Outputs sets total_ms when it publishes
};

/// The middle stage of the pipeline, between Intake and Outputs: tracks scans, and executes commands between
/// two scans. Searches run in parallel with tracking; in a replay they run in this thread, so that the result
/// depends on the scans and commands alone. To be used by one thread.
class Pipeline {
 public:
  enum class Mode : std::int8_t { kLive, kReplay };

  /// Loads the configured map. Throws std::runtime_error with a sentence when the map cannot be used.
  Pipeline(const Config& config, Statistics& statistics, Mode mode);

  FinishedScan process(const ReceivedScan& received);
  /// Executes a command. The result is counted; the reason for a rejection is logged.
  void execute(const Command& command);
  /// Saves the map in the background when the configured period has passed.
  void save_map_when_due();
  /// At the end: saves the configured map. Throws std::runtime_error with a sentence when that fails.
  void finish();

  /// The map around the robot, in the frame of the published poses.
  PointCloud map() const { return moved(mapper_.map(), body_from_sensor_); }
  /// The map for a map file.
  SavedMap saved_map() const { return mapper_.save(); }

  enum class Part : std::int8_t {
    kAll,    ///< the active submap and all earlier ones
    kFirst,  ///< the given map, and the submaps that have been joined to it
  };
  /// The points of all archived keyframes, in the frame of the published poses, thinned to `voxel` metres.
  PointCloud archived(float voxel, Part part) const;

  /// Needed for correction(): see Mapper.
  void keep_history() { mapper_.keep_history(); }
  /// The correction of a published pose of the body in the map as it is now: correction * published.
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
  ConsistencyCheck consistency_;
  PublisherWatch publishers_;
  BackgroundSearch search_;
};

}  // namespace scanlock
