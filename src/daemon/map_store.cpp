// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/map_store.hpp"

#include <filesystem>
#include <stdexcept>

#include "daemon/log.hpp"
#include "io/map_file.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration period_of(const MapConfig& config) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(config.save_period_s));
}

/// Poses tell: the points of a keyframe never change.
bool same_keyframes(const SavedMap& a, const SavedMap& b) {
  if (a.keyframes.size() != b.keyframes.size()) return false;
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const ArchivedKeyframe &one = a.keyframes[i], &other = b.keyframes[i];
    if (one.utime != other.utime || one.map_from_body.matrix() != other.map_from_body.matrix()) return false;
  }
  return true;
}

std::string described(const SavedMap& map) {
  std::size_t points = 0;
  for (const ArchivedKeyframe& keyframe : map.keyframes) points += keyframe.points->size();
  return std::to_string(map.keyframes.size()) + " keyframes, " + std::to_string(points) + " points";
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
  if (!std::filesystem::exists(config_.file, error)) {
    log_line(LogLevel::kInfo, config_.file + ": no map yet; it is written on exit");
    return std::nullopt;
  }
  SavedMap map = read_map(config_.file);
  log_line(LogLevel::kInfo, config_.file + ": map loaded: " + described(map));
  written_ = map;
  return map;
}

SavedMap MapStore::load(const std::string& path) const {
  const std::string file = resolved(path);
  SavedMap map = read_map(file);
  log_line(LogLevel::kInfo, file + ": map loaded: " + described(map));
  return map;
}

bool MapStore::is_busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  if (!writing_.get()) written_.reset();  // nobody knows what the file holds
  return false;
}

bool MapStore::write(const std::string& path, const SavedMap& map) {
  try {
    write_map(path, map);
    log_line(LogLevel::kInfo, path + ": map saved: " + described(map));
    return true;
  } catch (const std::exception& error) {
    statistics_.set_error(std::string("the map was not saved: ") + error.what());
    log_line(LogLevel::kError, std::string("the map was not saved: ") + error.what());
    return false;
  }
}

void MapStore::save(const std::string& path, SavedMap map) {
  const std::string file = resolved(path);
  if (map.keyframes.empty()) throw std::runtime_error(file + ": there is no map yet that could be saved");
  if (is_busy()) throw std::runtime_error(file + ": a map is being saved just now; ask again");
  if (file == config_.file) written_ = map;
  writing_ =
      std::async(std::launch::async, [this, file, saved = std::move(map)] { return write(file, saved); });
}

bool MapStore::is_due(Clock::time_point now) {
  if (config_.file.empty() || config_.save_period_s <= 0 || now < next_ || is_busy()) return false;
  next_ = now + period_of(config_);
  return true;
}

void MapStore::save_if_grown(SavedMap map) {
  if (map.keyframes.empty() || (written_ && same_keyframes(*written_, map))) return;
  save(config_.file, std::move(map));
}

void MapStore::save_at_exit(const SavedMap& map) {
  if (writing_.valid()) writing_.wait();
  if (is_busy() || config_.file.empty() || map.keyframes.empty()) return;
  const bool same =
      written_ && same_keyframes(*written_, map) && written_->last_pose.matrix() == map.last_pose.matrix();
  if (!same) write(config_.file, map);
}

}  // namespace scanlock
