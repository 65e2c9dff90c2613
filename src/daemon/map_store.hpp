// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <exception>
#include <future>
#include <optional>
#include <string>

#include "daemon/config.hpp"
#include "daemon/statistics.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// Whether a path names a bare cloud, which a map can be made of: .ply or .pcd, in any case.
bool is_bare_cloud(const std::string& path);

/// The unit vector of one of kAxes.
Eigen::Vector3d axis_of(const std::string& name);

/// Where a map is saved to without being told: the configured file, or the .map beside a bare cloud; empty
/// where none is configured, and where it stays as it is.
std::string saved_map_file(const MapConfig& config);

/// A map to find one's place in.
struct LoadedMap {
  SavedMap map;
  bool fixed = false;  ///< it stays as it is, see Mapper::load
};

/// The daemon's map file. Writing is done in the background, one at a time, so that the disk never holds up
/// the tracking; what goes wrong there is logged and becomes the last error.
class MapStore {
 public:
  MapStore(const Config& config, Statistics& statistics);

  /// What the configured file holds; nothing when none is configured, or there is none yet. Throws
  /// std::runtime_error for one that cannot be used.
  std::optional<LoadedMap> load_at_start();
  /// Throws std::runtime_error naming what is wrong; `path` empty: the configured one.
  LoadedMap load(const std::string& path) const;

  /// Begins to write `map`. Throws std::runtime_error when that cannot be begun; once it is written, or could
  /// not be, the command is counted as taken or rejected. `path` empty: the configured one.
  void save_on_command(const std::string& path, SavedMap map);

  /// True when the configured period has passed and a periodic save could begin.
  bool is_due(std::chrono::steady_clock::time_point now);
  /// Saves to the configured file in the background, unless that holds these keyframes already.
  void save_if_grown(SavedMap map);

  /// At the end: waits for a save under way, then writes the configured file, unless it holds this map
  /// already. Throws std::runtime_error when that fails.
  void save_at_exit(const SavedMap& map);

 private:
  LoadedMap read(const std::string& file) const;
  void save(const std::string& path, SavedMap map, bool commanded);
  bool is_busy();
  bool is_another(const SavedMap& map) const;
  void complain(const std::exception& error);
  void write(const std::string& path, const SavedMap& map, bool keep_old);

  const MapConfig config_;
  const std::string saved_file_;  ///< see saved_map_file()
  const Pose body_from_sensor_;
  const double max_range_m_;
  const int threads_;
  Statistics& statistics_;
  std::future<bool> writing_;  ///< whether it succeeded; what went wrong was said
  std::chrono::steady_clock::time_point next_;
  std::optional<SavedMap> written_;  ///< as the configured file holds it; shares its points with the tracker
};

}  // namespace scanlock
