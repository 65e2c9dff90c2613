// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "simulation/drive.hpp"
#include "simulation/event.hpp"
#include "simulation/lidar.hpp"
#include "simulation/world.hpp"

namespace scanlock {

struct SimulationConfig {
  WorldKind world = WorldKind::kUrban;
  LidarKind lidar = LidarKind::kVlp16;
  /// Of the drive; nothing: 60 s, or the time that the laps take. With `laps`, the earlier end counts.
  std::optional<double> seconds;
  std::optional<int> laps;  ///< of a closed loop; nothing: the world's route without laps
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> drive_seed;  ///< for route, traffic and noise; nothing: the world's seed
  double moved = 0;  ///< fraction of the furniture and parked cars that are moved, 0 to 1
  std::vector<SimulationEvent> events;
  double speed_mps = 0;           ///< cruising speed; 0: that of the world
  double start_speed_mps = 0;     ///< at the start of the drive
  std::optional<double> noise_m;  ///< standard deviation of ranges; nothing: that of the sensor
  int column_step = 1;            ///< see LidarModel
  bool motion_distortion = true;  ///< false: all points of a scan are measured at its stamp, with time 0
  bool stamp_at_end = false;      ///< scans are stamped at the end of the sweep instead of at its start
  int threads = 1;                ///< the result does not depend on it
};

struct SimulatedScan {
  Scan scan;                                ///< with intensity (0 to 255) and time
  Pose world_from_body = Pose::Identity();  ///< exact, at scan.utime
  Vector6 twist = Vector6::Zero();  ///< exact body velocity [m/s; rad/s] at scan.utime, in the body frame
  double time_s = 0;                ///< scan.utime in seconds since the start of the drive
};

/// A LiDAR that is driven through a world. Each ray starts from the exact pose at its own time. The result
/// depends on the configuration alone, not on the number of threads.
class Simulator {
 public:
  /// utime of the start of the drive, microseconds.
  static constexpr std::int64_t kStartUtime = 1600000000000000;

  /// Throws std::invalid_argument with a sentence when the configuration is invalid.
  explicit Simulator(const SimulationConfig& config);

  /// The next scan; nothing when the drive is over.
  std::optional<SimulatedScan> next();

  /// Length of the drive in seconds.
  double seconds() const { return seconds_; }
  /// Sweeps of the whole drive, including those lost in a dropout.
  std::int64_t sweeps() const;
  /// The first sweep that the next call of next() considers.
  std::int64_t position() const { return sweep_; }

  /// The exact pose at time t, seconds since the start, for the sweep that began at `sweep_begin`: a kidnap
  /// takes effect between two sweeps.
  Pose pose_at(double t, double sweep_begin) const;

  const World& world() const { return world_; }
  const Drive& drive() const { return drive_; }
  const LidarModel& lidar() const { return lidar_; }

 private:
  struct Moving;
  struct Return {
    float range = 0;  // 0: no return
    float intensity = 0;
  };
  bool event_active(EventKind kind, double t) const;
  SimulatedScan make_scan(std::int64_t sweep) const;
  std::vector<Moving> movers_near(const Eigen::Vector3d& sensor, double heading, double t) const;
  void cast_beams(std::int64_t sweep, double stamp, const std::vector<Moving>& movers, std::size_t begin,
                  std::size_t end, Return* returns) const;
  Hit cast(const Ray& ray, double since, const std::vector<Moving>& movers, std::uint64_t seed) const;
  float point_time(const Beam& beam) const;

  SimulationConfig config_;
  LidarModel lidar_;
  World world_;
  double seconds_;
  Drive drive_;
  std::vector<Beam> beams_;  // of the current sweep
  std::int64_t sweep_ = 0;
};

}  // namespace scanlock
