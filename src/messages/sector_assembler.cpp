// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/sector_assembler.hpp"

#include <utility>

namespace scanlock {
namespace {

/// A sector older than the current scan by less than this is late; by more, the sender has begun anew.
constexpr std::int64_t kLatenessUs = 1000000;

void append(std::vector<float>& to, const std::vector<float>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Times and intensities survive only if each slice with points has them: an array is whole or empty.
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
  if (decoded.fault != DecodeFault::kNone || decoded.type != "scanlock.scan_sector_t") {
    finished.push_back(std::move(decoded));
    return finished;
  }
  const bool same_scan = any_ && decoded.scan.utime == newest_utime_ && decoded.seq == newest_seq_;
  if (same_scan ? !waiting_.has_value() : is_late(decoded)) {
    ++discarded_sectors_;
    return finished;
  }
  if (!same_scan) {
    if (std::optional<DecodedScan> incomplete = flush()) finished.push_back(std::move(*incomplete));
    any_ = true;
    newest_utime_ = decoded.scan.utime;
    newest_seq_ = decoded.seq;
    waiting_.emplace();
  }
  if (!insert(decoded)) {
    ++discarded_sectors_;
    return finished;
  }
  if (waiting_->points.size() == static_cast<std::size_t>(waiting_->head.sector_count))
    finished.push_back(*flush());
  return finished;
}

std::optional<DecodedScan> SectorAssembler::flush() {
  if (!waiting_ || waiting_->points.empty()) return std::nullopt;
  DecodedScan scan = std::move(waiting_->head);
  scan.scan.points = joined(waiting_->points);
  scan.sectors_missing = static_cast<std::size_t>(scan.sector_count) - waiting_->points.size();
  waiting_.reset();
  return scan;
}

bool SectorAssembler::is_late(const DecodedScan& sector) const {
  if (!any_) return false;
  // Unsigned: the stamps are whatever a sender wrote, and their difference may not fit.
  const std::uint64_t age =
      static_cast<std::uint64_t>(newest_utime_) - static_cast<std::uint64_t>(sector.scan.utime);
  return sector.scan.utime < newest_utime_ && age < static_cast<std::uint64_t>(kLatenessUs);
}

bool SectorAssembler::insert(DecodedScan& sector) {
  Slices& slices = *waiting_;
  if (slices.point_count + sector.scan.points.size() > max_points_) return false;
  if (!slices.points.empty() && sector.sector_count != slices.head.sector_count) return false;
  if (slices.points.count(sector.sector_index) > 0) return false;
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
