// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/sector_assembler.hpp"

#include <algorithm>
#include <utility>

namespace scanlock {
namespace {

/// Number of recent scans whose late sectors are recognised. Stamps alone do not show that a sector is late:
/// clocks can step back.
constexpr std::size_t kRemembered = 16;

void append(std::vector<float>& to, const std::vector<float>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Times and intensities are kept only if every sector with points has them, since each array of a cloud must
/// be complete or empty.
PointCloud joined(const std::map<int, PointCloud>& slices) {
  bool times = true, intensities = true;
  for (const auto& [index, slice] : slices) {
    times = times && (slice.empty() || slice.has_times());
    intensities = intensities && (slice.empty() || slice.has_intensity());
  }
  PointCloud points;
  for (const auto& [index, slice] : slices) {
    append(points.x, slice.x);
    append(points.y, slice.y);
    append(points.z, slice.z);
    if (times) append(points.time, slice.time);
    if (intensities) append(points.intensity, slice.intensity);
  }
  return points;
}

}  // namespace

std::vector<DecodedScan> SectorAssembler::add(DecodedScan decoded) {
  std::vector<DecodedScan> finished;
  if (decoded.fault != DecodeFault::kNone || !decoded.is_sector()) {
    finished.push_back(std::move(decoded));
    return finished;
  }
  const Key key(decoded.scan.utime, decoded.seq);
  const bool current = waiting_ && !begun_.empty() && key == begun_.back();
  if (!current) {
    const bool named = key != Key(0, 0);  // without stamp and count, a sector always begins a new scan
    if (named && std::find(begun_.begin(), begun_.end(), key) != begun_.end()) {
      discard("its scan was passed on already");
      return finished;
    }
    if (std::optional<DecodedScan> incomplete = flush()) finished.push_back(std::move(*incomplete));
    begin(key);
  }
  if (insert(decoded) && waiting_->points.size() == static_cast<std::size_t>(waiting_->head.sector_count))
    finished.push_back(*flush());
  return finished;
}

void SectorAssembler::begin(const Key& key) {
  begun_.push_back(key);
  if (begun_.size() > kRemembered) begun_.pop_front();
  waiting_ = Slices();
}

std::optional<DecodedScan> SectorAssembler::flush() {
  if (!waiting_ || waiting_->points.empty()) return std::nullopt;
  DecodedScan scan = std::move(waiting_->head);
  scan.scan.points = joined(waiting_->points);
  scan.sectors_missing = static_cast<std::size_t>(scan.sector_count) - waiting_->points.size();
  waiting_.reset();
  return scan;
}

bool SectorAssembler::discard(const char* why) {
  ++discarded_sectors_;
  last_discarded_ = why;
  return false;
}

bool SectorAssembler::insert(DecodedScan& sector) {
  Slices& slices = *waiting_;
  if (slices.point_count + sector.scan.points.size() > max_points_)
    return discard("its scan has too many points");
  if (!slices.points.empty() && sector.sector_count != slices.head.sector_count)
    return discard("its `sector_count` differs from that of the other sectors");
  if (slices.points.count(sector.sector_index) > 0) return discard("it is a duplicate");
  slices.point_count += sector.scan.points.size();
  slices.points.emplace(sector.sector_index, std::exchange(sector.scan.points, {}));
  if (slices.points.size() == 1) {
    slices.head = std::move(sector);
  } else {
    slices.head.nonfinite_points += sector.nonfinite_points;
  }
  return true;
}

}  // namespace scanlock
