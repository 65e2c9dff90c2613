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

/// Whether a path names a bare cloud, from which a map can be made: .ply or .pcd, upper or lower case.
bool is_bare_cloud(const std::string& path);

/// The unit vector of an element of kAxes.
Eigen::Vector3d axis_of(const std::string& name);

/// The file for saving without a command: the configured file, or the .map beside a bare cloud; empty when no
/// file is configured, and when the map is not to be changed (localise).
std::string saved_map_file(const MapConfig& config);

/// A map for relocalisation.
struct LoadedMap {
  SavedMap map;
  bool fixed = false;  ///< it is not changed, see Mapper::load()
};

/// The daemon's map file. Files are written in the background, one at a time, so that the disk never delays
/// tracking; errors while writing are logged and become the last error of the status.
class MapStore {
 public:
  MapStore(const Config& config, Statistics& statistics);

  /// The map of the configured file; nothing when no file is configured, or the file does not exist yet.
  /// Throws std::runtime_error for a file that cannot be used.
  std::optional<LoadedMap> load_at_start();
  /// Loads a map; an empty `path` means the configured file. Throws std::runtime_error with the reason.
  LoadedMap load(const std::string& path) const;

  /// Starts to write `map`; an empty `path` means the configured file. Throws std::runtime_error when writing
  /// cannot start. When it ends, the command is counted as taken or rejected.
  void save_on_command(const std::string& path, SavedMap map);

  /// True when the configured period has passed and a periodic save can start.
  bool is_due(std::chrono::steady_clock::time_point now);
  /// Saves to the configured file in the background, unless that file already holds these keyframes.
  void save_if_grown(SavedMap map);

  /// At the end: waits for a running save, then writes the configured file, unless it already holds this map.
  /// Throws std::runtime_error when that fails.
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
  std::future<bool> writing_;  ///< true on success; errors have been logged
  std::chrono::steady_clock::time_point next_;
  std::optional<SavedMap> written_;  ///< content of the configured file; shares its points with the tracker
};

}  // namespace scanlock
