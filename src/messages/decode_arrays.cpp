// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Scan types that consist of plain arrays: pointcloud_t, the two planar scanners, and scanlock's own
// scan_sector_t.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/elementary.hpp"
#include "messages/point_times.hpp"
#include "messages/scan_types.hpp"

namespace scanlock {
namespace {

bool check_point_count(std::size_t count, const char* member, const DecodeLimits& limits,
                       ByteReader& reader) {
  if (reader.ok() && count > limits.max_points)
    reader.fail(DecodeFault::kBadSize, std::string("`") + member + "` is " + std::to_string(count) +
                                           ", over the limit of " + std::to_string(limits.max_points) +
                                           " points");
  return reader.ok();
}

/// Reads element `index` of an array that the caller has found complete.
float float_at(ByteView view, std::size_t index) {
  ByteReader reader(view.data + 4 * index, 4);
  return reader.read_float("");
}
std::int64_t int64_at(ByteView view, std::size_t index) {
  ByteReader reader(view.data + 8 * index, 8);
  return reader.read_i64("");
}
std::int16_t int16_at(ByteView view, std::size_t index) {
  return static_cast<std::int16_t>(view.data[2 * index] << 8 | view.data[2 * index + 1]);
}

float finite_or_zero(float value) {
  return std::isfinite(value) ? value : 0.0f;
}

/// Appends the point unless it is not finite or exactly 0 0 0; returns whether it was appended.
bool keep_point(float x, float y, float z, DecodedScan& decoded) {
  const bool usable =
      std::isfinite(x) && std::isfinite(y) && std::isfinite(z) && (x != 0 || y != 0 || z != 0);
  if (usable)
    decoded.scan.points.push_back(x, y, z);
  else
    ++decoded.nonfinite_points;
  return usable;
}

/// Appends the return of a planar scanner. A range that is not positive, or at least `planar_no_return_m`, is
/// not a return.
bool keep_beam(float range, float angle, const DecodeLimits& limits, DecodedScan& decoded) {
  if (!(range > 0 && static_cast<double>(range) < limits.planar_no_return_m)) range = std::nanf("");
  return keep_point(range * cos(angle), range * sin(angle), 0.0f, decoded);
}

}  // namespace

void decode_pointcloud(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  decoded.scan.utime = reader.read_i64("utime");
  decoded.seq = reader.read_i32("seq");
  decoded.frame_id = reader.read_string("frame_id");
  const std::size_t count = reader.read_count_i32("n_points", 12);
  if (!check_point_count(count, "n_points", limits, reader)) return;
  const ByteView coordinates = reader.read_bytes(12 * count, "points");
  const std::size_t channel_count = reader.read_count_i32("n_channels", 5 + 4 * count);
  std::size_t time_channel = channel_count, intensity_channel = channel_count;
  std::string time_name;
  for (std::size_t i = 0; i < channel_count && reader.ok(); ++i) {
    const std::string_view name = reader.read_string("channel_names");
    if (name == "intensity") intensity_channel = i;
    if (time_channel == channel_count && time_name_rank(name)) {
      time_channel = i;
      time_name = name;
    }
  }
  ByteView times, intensities;
  for (std::size_t i = 0; i < channel_count && reader.ok(); ++i) {
    const ByteView channel = reader.read_bytes(4 * count, "channels");
    if (i == time_channel) times = channel;
    if (i == intensity_channel) intensities = channel;
  }
  reader.expect_end();
  if (!reader.ok()) return;

  PointCloud& points = decoded.scan.points;
  points.reserve(count);
  std::vector<double> raw_times;
  for (std::size_t i = 0; i < count; ++i) {
    const bool kept = keep_point(float_at(coordinates, 3 * i), float_at(coordinates, 3 * i + 1),
                                 float_at(coordinates, 3 * i + 2), decoded);
    if (kept && times.data != nullptr) raw_times.push_back(static_cast<double>(float_at(times, i)));
    if (kept && intensities.data != nullptr)
      points.intensity.push_back(finite_or_zero(float_at(intensities, i)));
  }
  decoded.time_field = times.data == nullptr ? "no time channel"
                                             : interpret_times(time_name, TimeKind::kFloat32,
                                                               decoded.scan.utime, raw_times, points.time);
}

void decode_planar_lidar(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  decoded.scan.utime = reader.read_i64("utime");
  const std::size_t count = reader.read_count_i32("nranges", 4);
  if (!check_point_count(count, "nranges", limits, reader)) return;
  const ByteView ranges = reader.read_bytes(4 * count, "ranges");
  const std::size_t intensity_count = reader.read_count_i32("nintensities", 4);
  const ByteView intensities = reader.read_bytes(4 * intensity_count, "intensities");
  const float first_angle = reader.read_float("rad0");
  const float angle_step = reader.read_float("radstep");
  reader.expect_end();
  if (reader.ok() && !(std::isfinite(first_angle) && std::isfinite(angle_step)))
    reader.fail(DecodeFault::kBadField, "`rad0` or `radstep` is not finite");
  if (reader.ok() && intensity_count != 0 && intensity_count != count)
    reader.fail(DecodeFault::kBadSize, "`nintensities` is " + std::to_string(intensity_count) + " with " +
                                           std::to_string(count) + " ranges; it must be 0 or the same");
  if (!reader.ok()) return;

  decoded.scan.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    if (keep_beam(float_at(ranges, i), first_angle + static_cast<float>(i) * angle_step, limits, decoded) &&
        intensity_count > 0)
      decoded.scan.points.intensity.push_back(finite_or_zero(float_at(intensities, i)));
  decoded.time_field = "no time of each beam in this type";
}

void decode_mbot_lidar(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  decoded.scan.utime = reader.read_i64("utime");
  const std::size_t count = reader.read_count_i32("num_ranges", 4 + 4 + 8 + 4);
  if (!check_point_count(count, "num_ranges", limits, reader)) return;
  const ByteView ranges = reader.read_bytes(4 * count, "ranges");
  const ByteView thetas = reader.read_bytes(4 * count, "thetas");
  const ByteView times = reader.read_bytes(8 * count, "times");
  const ByteView intensities = reader.read_bytes(4 * count, "intensities");
  reader.expect_end();
  if (!reader.ok()) return;

  const float sense = limits.mbot_clockwise ? -1.0f : 1.0f;
  std::vector<double> raw_times;
  for (std::size_t i = 0; i < count; ++i) {
    if (!keep_beam(float_at(ranges, i), sense * float_at(thetas, i), limits, decoded)) continue;
    decoded.scan.points.intensity.push_back(finite_or_zero(float_at(intensities, i)));
    raw_times.push_back(static_cast<double>(int64_at(times, i)));
  }
  decoded.time_field = interpret_times("times", TimeKind::kMicrosecondsOfEpoch, decoded.scan.utime, raw_times,
                                       decoded.scan.points.time);
}

void decode_scan_sector(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  decoded.scan.utime = reader.read_i64("utime");
  decoded.seq = reader.read_i32("seq");
  decoded.sector_index = reader.read_i16("sector_index");
  decoded.sector_count = reader.read_i16("sector_count");
  decoded.frame_id = reader.read_string("frame_id");
  const std::size_t count = reader.read_count_i32("num_points", 6);
  if (!check_point_count(count, "num_points", limits, reader)) return;
  const float scale = reader.read_float("coordinate_scale");
  const ByteView x = reader.read_bytes(2 * count, "x");
  const ByteView y = reader.read_bytes(2 * count, "y");
  const ByteView z = reader.read_bytes(2 * count, "z");
  const float time_origin = reader.read_float("time_origin");
  const float time_scale = reader.read_float("time_scale");
  const std::size_t time_count = reader.read_count_i32("num_times", 2);
  const ByteView times = reader.read_bytes(2 * time_count, "times");
  const float intensity_scale = reader.read_float("intensity_scale");
  const std::size_t intensity_count = reader.read_count_i32("num_intensities", 1);
  const ByteView intensities = reader.read_bytes(intensity_count, "intensities");
  reader.expect_end();
  if (reader.ok() &&
      (decoded.sector_count < 1 || decoded.sector_index < 0 || decoded.sector_index >= decoded.sector_count))
    reader.fail(DecodeFault::kBadSize, "`sector_index` " + std::to_string(decoded.sector_index) +
                                           " is not below `sector_count` " +
                                           std::to_string(decoded.sector_count));
  if (reader.ok() &&
      ((time_count != 0 && time_count != count) || (intensity_count != 0 && intensity_count != count)))
    reader.fail(DecodeFault::kBadSize, "`num_times` or `num_intensities` is neither 0 nor `num_points`");
  // At most 100 (metres per count, seconds): far above any scan, and no product below exceeds the range of
  // float.
  const auto plausible = [](float value) { return std::isfinite(value) && std::abs(value) <= 100.0f; };
  if (reader.ok() && (!(plausible(scale) && scale > 0) || !plausible(time_origin) ||
                      !plausible(time_scale * 32768.0f) || !std::isfinite(intensity_scale)))
    reader.fail(DecodeFault::kBadField,
                "`coordinate_scale`, `time_origin`, `time_scale` or `intensity_scale` is out of range");
  if (!reader.ok()) return;

  PointCloud& points = decoded.scan.points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!keep_point(scale * static_cast<float>(int16_at(x, i)), scale * static_cast<float>(int16_at(y, i)),
                    scale * static_cast<float>(int16_at(z, i)), decoded))
      continue;
    if (time_count > 0)
      points.time.push_back(time_origin + time_scale * static_cast<float>(int16_at(times, i)));
    if (intensity_count > 0)
      points.intensity.push_back(finite_or_zero(intensity_scale * static_cast<float>(intensities.data[i])));
  }
  decoded.time_field = time_count > 0 ? "`times` of the sector" : "no times in the sector";
}

}  // namespace scanlock
