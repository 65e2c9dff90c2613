// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/map_store.hpp"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "daemon/mount.hpp"
#include "io/cloud_file.hpp"
#include "io/input_file.hpp"
#include "io/map_file.hpp"
#include "mapping/cloud_map.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration period_of(const MapConfig& config) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(config.save_period_s));
}

/// Equal up to rounding: a loaded map has been transformed to another frame and back.
bool same_pose(const Pose& a, const Pose& b) {
  constexpr double kRounding = 1e-6;  // metres, radians
  return near(a, b, kRounding, kRounding);
}

/// The members of a keyframe that never change. The utime of a keyframe made from a bare cloud is only an
/// index.
using Identity = std::tuple<std::int64_t, float, std::size_t>;
Identity identity(const ArchivedKeyframe& keyframe) {
  return {keyframe.utime, keyframe.reach, keyframe.points.size()};
}

bool same_keyframes(const SavedMap& a, const SavedMap& b) {
  return std::equal(a.keyframes.begin(), a.keyframes.end(), b.keyframes.begin(), b.keyframes.end(),
                    [](const ArchivedKeyframe& one, const ArchivedKeyframe& other) {
                      return identity(one) == identity(other) &&
                             same_pose(one.map_from_body, other.map_from_body);
                    });
}

bool share_a_keyframe(const SavedMap& a, const SavedMap& b) {
  std::set<Identity> identities;
  for (const ArchivedKeyframe& keyframe : a.keyframes) identities.insert(identity(keyframe));
  return std::any_of(b.keyframes.begin(), b.keyframes.end(), [&](const ArchivedKeyframe& keyframe) {
    return identities.count(identity(keyframe)) > 0;
  });
}

std::string described(const SavedMap& map) {
  std::size_t points = 0;
  for (const ArchivedKeyframe& keyframe : map.keyframes) points += keyframe.points.size();
  return std::to_string(map.keyframes.size()) + " keyframes, " + std::to_string(points) + " points";
}

constexpr const char* kNoFile =
    "no map file is named, neither in the command nor in the configuration (map.file)";
constexpr const char* kStays =
    "the configured map is not written in this mode (map.mode); name a file to save to";

bool stays_as_it_is(const MapConfig& config, const std::string& file) {
  return config.mode == "localise" || (config.mode == "auto" && is_bare_cloud(file));
}

void keep(const std::string& file, const Statistics& statistics) {
  const std::string kept = file + ".old";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return;
  std::filesystem::remove(kept, error);  // not overwritten: a loaded map may still read its points from it
  if (!error) std::filesystem::copy_file(file, kept, error);
  if (error) throw std::runtime_error(kept + ": cannot keep a copy of the previous map: " + error.message());
  statistics.say(LogLevel::kInfo, file + ": holds a different map, which is kept as " + kept);
}

}  // namespace

Eigen::Vector3d axis_of(const std::string& name) {
  return (name.front() == '-' ? -1 : 1) * Eigen::Vector3d::Unit(name.back() - 'x');
}

bool is_bare_cloud(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".ply" || extension == ".pcd";
}

std::string saved_map_file(const MapConfig& config) {
  if (config.file.empty() || stays_as_it_is(config, config.file)) return {};
  return is_bare_cloud(config.file) ? std::filesystem::path(config.file).replace_extension(".map").string()
                                    : config.file;
}

MapStore::MapStore(const Config& config, Statistics& statistics)
    : config_(config.daemon.map),
      saved_file_(saved_map_file(config.daemon.map)),
      body_from_sensor_(body_from_sensor(config.daemon.mount)),
      max_range_m_(config.tracker.max_range_m),
      threads_(config.tracker.threads),
      statistics_(statistics),
      next_(Clock::now() + period_of(config.daemon.map)) {}

std::optional<LoadedMap> MapStore::load_at_start() {
  std::error_code error;
  if (config_.file.empty()) return std::nullopt;
  if (!saved_file_.empty() && !std::filesystem::exists(saved_file_, error) && !error) {
    const std::string folder = std::filesystem::absolute(saved_file_).parent_path();
    if (access(folder.c_str(), W_OK) != 0)  // report this at the start, not after the drive
      throw std::runtime_error(saved_file_ + ": cannot be created: " + std::strerror(errno));
    statistics_.say(LogLevel::kInfo, saved_file_ + ": no map yet; it is written on exit");
    if (saved_file_ == config_.file) return std::nullopt;
    return read(config_.file);
  }
  if (!saved_file_.empty() && saved_file_ != config_.file) {
    const std::string instead = saved_file_ + ": is used instead of " + config_.file;
    const bool newer = std::filesystem::last_write_time(config_.file, error) >
                       std::filesystem::last_write_time(saved_file_, error);
    if (newer && !error)
      statistics_.complain(instead + ", which is newer; to load that, move the .map away");
    else
      statistics_.say(LogLevel::kInfo, instead + ", from which it was made");
  }
  try {
    LoadedMap loaded = read(saved_file_.empty() ? config_.file : saved_file_);
    if (!saved_file_.empty()) written_ = loaded.map;
    return loaded;
  } catch (const std::runtime_error& damage) {
    throw std::runtime_error(damage.what() +
                             std::string(saved_file_.empty() ? "" : "; move it away to begin a new map"));
  }
}

LoadedMap MapStore::load(const std::string& path) const {
  if (path.empty() && config_.file.empty()) throw std::runtime_error(kNoFile);
  return read(path.empty() ? config_.file : path);
}

/// Coordinates of a bare cloud are in the body's map frame, those of all other maps in the sensor's.
LoadedMap MapStore::read(const std::string& file) const {
  const InputFile readable(file);  // throws before the log announces the file
  LoadedMap loaded;
  loaded.fixed = stays_as_it_is(config_, file);
  const Pose sensor_from_body = body_from_sensor_.inverse();
  const Eigen::Vector3d up = sensor_from_body.linear() * axis_of(config_.up);
  if (is_bare_cloud(file)) {
    statistics_.say(LogLevel::kInfo, file + ": a bare cloud; making a map of it");
    CloudMapBuilder builder({up, max_range_m_, sensor_from_body, threads_});
    read_cloud(file, [&](PointCloud&& part) { builder.add(std::move(part)); });
    loaded.map = builder.build(file);
    for (const std::string& warning : builder.warnings()) statistics_.complain(file + ": " + warning);
  } else {
    loaded.map = read_map(file);
    if (file == saved_file_ && is_bare_cloud(config_.file))
      loaded.map.up = up;  // it was made from the cloud; files before version 4 do not store `up`
  }
  statistics_.say(LogLevel::kInfo, file + ": map loaded: " + described(loaded.map));
  return loaded;
}

bool MapStore::is_busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  if (!writing_.get()) written_.reset();  // the write failed: the content of the file is unknown
  return false;
}

void MapStore::write(const std::string& path, const SavedMap& map, bool keep_old) {
  if (keep_old) keep(path, statistics_);
  write_map(path, map);
  statistics_.say(LogLevel::kInfo, path + ": map saved: " + described(map));
}

void MapStore::complain(const std::exception& error) {
  statistics_.complain(std::string("the map was not saved: ") + error.what());
}

void MapStore::save_on_command(const std::string& path, SavedMap map) {
  save(path, std::move(map), true);
}

void MapStore::save(const std::string& path, SavedMap map, bool commanded) {
  const std::string& file = path.empty() ? saved_file_ : path;
  if (file.empty()) throw std::runtime_error(config_.file.empty() ? kNoFile : kStays);
  if (map.keyframes.empty()) throw std::runtime_error(file + ": there is no map yet to save");
  if (is_busy()) throw std::runtime_error(file + ": a map is being saved; repeat the command later");
  const bool keep_old = file == saved_file_ && is_another(map);
  if (file == saved_file_) written_ = map;
  writing_ = std::async(std::launch::async, [this, file, keep_old, commanded, saved = std::move(map)] {
    try {
      write(file, saved, keep_old);
    } catch (const std::exception& error) {
      if (commanded) statistics_.count(&Counters::commands_rejected);
      complain(error);
      return false;
    }
    if (commanded) statistics_.count(&Counters::commands);
    return true;
  });
}

bool MapStore::is_another(const SavedMap& map) const {
  return written_ && !written_->keyframes.empty() && !share_a_keyframe(*written_, map);
}

bool MapStore::is_due(Clock::time_point now) {
  if (saved_file_.empty() || config_.save_period_s <= 0 || now < next_ || is_busy()) return false;
  next_ = now + period_of(config_);
  return true;
}

void MapStore::save_if_grown(SavedMap map) {
  if (map.keyframes.empty() || (written_ && same_keyframes(*written_, map))) return;
  try {
    save(saved_file_, std::move(map), false);
  } catch (const std::exception& error) {
    complain(error);
  }
}

void MapStore::save_at_exit(const SavedMap& map) {
  if (writing_.valid()) writing_.wait();
  if (is_busy() || saved_file_.empty() || map.keyframes.empty()) return;
  const bool same =
      written_ && same_keyframes(*written_, map) && same_pose(written_->last_pose, map.last_pose);
  if (same) return;
  try {
    write(saved_file_, map, is_another(map));
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("the map was not saved: ") + error.what());
  }
}

}  // namespace scanlock
