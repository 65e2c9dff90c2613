// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/map_store.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "daemon/map_file.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration period_of(const MapConfig& config) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(config.save_period_s));
}

/// Rounding apart: a map that was loaded has been moved there and back.
bool same_pose(const Pose& a, const Pose& b) {
  constexpr double kRounding = 1e-6;  // metres, radians
  return near(a, b, kRounding, kRounding);
}

/// Poses tell: the points of a keyframe never change.
bool same_keyframes(const SavedMap& a, const SavedMap& b) {
  if (a.keyframes.size() != b.keyframes.size()) return false;
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const ArchivedKeyframe &one = a.keyframes[i], &other = b.keyframes[i];
    if (one.utime != other.utime || !same_pose(one.map_from_body, other.map_from_body)) return false;
  }
  return true;
}

bool share_a_keyframe(const SavedMap& a, const SavedMap& b) {
  std::set<std::int64_t> utimes;
  for (const ArchivedKeyframe& keyframe : a.keyframes) utimes.insert(keyframe.utime);
  return std::any_of(b.keyframes.begin(), b.keyframes.end(),
                     [&](const ArchivedKeyframe& keyframe) { return utimes.count(keyframe.utime) > 0; });
}

std::string described(const SavedMap& map) {
  std::size_t points = 0;
  for (const ArchivedKeyframe& keyframe : map.keyframes) points += keyframe.points->size();
  return std::to_string(map.keyframes.size()) + " keyframes, " + std::to_string(points) + " points";
}

void keep(const std::string& file, const Statistics& statistics) {
  const std::string kept = file + ".old";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return;
  std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing, error);
  if (error) throw std::runtime_error(kept + ": cannot keep the map before: " + error.message());
  statistics.say(LogLevel::kInfo, file + ": holds another map, which is kept as " + kept);
}

}  // namespace

MapStore::MapStore(const MapConfig& config, Statistics& statistics)
    : config_(config), statistics_(statistics), next_(Clock::now() + period_of(config)) {}

std::string MapStore::resolved(const std::string& path) const {
  if (!path.empty()) return path;
  if (config_.file.empty())
    throw std::runtime_error(
        "no map file is named, neither in the command nor in the configuration (map.file)");
  return config_.file;
}

std::optional<SavedMap> MapStore::load_at_start() {
  std::error_code error;
  if (config_.file.empty()) return std::nullopt;
  if (!std::filesystem::exists(config_.file, error) && !error) {
    const std::string folder = std::filesystem::absolute(config_.file).parent_path();
    if (access(folder.c_str(), W_OK) != 0)  // better said now than after the drive
      throw std::runtime_error(config_.file + ": cannot be created there: " + std::strerror(errno));
    statistics_.say(LogLevel::kInfo, config_.file + ": no map yet; it is written on exit");
    return std::nullopt;
  }
  SavedMap map;
  try {
    map = read_map(config_.file);
  } catch (const std::runtime_error& damage) {
    throw std::runtime_error(std::string(damage.what()) + "; move it away to begin a new map");
  }
  statistics_.say(LogLevel::kInfo, config_.file + ": map loaded: " + described(map));
  written_ = map;
  return map;
}

SavedMap MapStore::load(const std::string& path) const {
  const std::string file = resolved(path);
  SavedMap map = read_map(file);
  statistics_.say(LogLevel::kInfo, file + ": map loaded: " + described(map));
  return map;
}

bool MapStore::is_busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  if (!writing_.get()) written_.reset();  // nobody knows what the file holds
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
  const std::string file = resolved(path);
  if (map.keyframes.empty()) throw std::runtime_error(file + ": there is no map yet that could be saved");
  if (is_busy()) throw std::runtime_error(file + ": a map is being saved just now; ask again");
  const bool keep_old = file == config_.file && is_another(map);
  if (file == config_.file) written_ = map;
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
  if (config_.file.empty() || config_.save_period_s <= 0 || now < next_ || is_busy()) return false;
  next_ = now + period_of(config_);
  return true;
}

void MapStore::save_if_grown(SavedMap map) {
  if (map.keyframes.empty() || (written_ && same_keyframes(*written_, map))) return;
  try {
    save(config_.file, std::move(map), false);
  } catch (const std::exception& error) {
    complain(error);
  }
}

void MapStore::save_at_exit(const SavedMap& map) {
  if (writing_.valid()) writing_.wait();
  if (is_busy() || config_.file.empty() || map.keyframes.empty()) return;
  const bool same =
      written_ && same_keyframes(*written_, map) && same_pose(written_->last_pose, map.last_pose);
  if (same) return;
  try {
    write(config_.file, map, is_another(map));
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("the map was not saved: ") + error.what());
  }
}

}  // namespace scanlock
