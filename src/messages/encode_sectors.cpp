// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>
#include <scanlock/scan_sector_t.hpp>

#include "geometry/elementary.hpp"
#include "messages/encode_scan.hpp"
#include "messages/generated_bytes.hpp"

namespace scanlock {
namespace {

constexpr float kMaxCoordinate = 3000.0f;  // metres
constexpr float kMaxTime = 50.0f;          // seconds from the stamp
constexpr std::size_t kBytesPerPoint = 3 * 2 + 2 + 1;
constexpr std::size_t kMaxSectors = 32767;

using Order = std::vector<std::uint32_t>;

/// Indices of the points that can be sent, in the order of measurement.
Order sweep_order(const PointCloud& points) {
  Order order;
  order.reserve(points.size());
  const auto usable = [](float c) { return std::abs(c) <= kMaxCoordinate; };  // false for NaN
  const auto timely = [&](std::uint32_t i) {
    return !points.has_times() || std::abs(points.time[i]) <= kMaxTime;
  };
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (usable(points.x[i]) && usable(points.y[i]) && usable(points.z[i]) && timely(i)) order.push_back(i);
  std::vector<float> key(points.size());
  for (const std::uint32_t i : order)
    key[i] = points.has_times() ? points.time[i] : atan2(points.y[i], points.x[i]);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
  return order;
}

std::int16_t to_count(float value, float scale) {
  return static_cast<std::int16_t>(std::clamp(std::lround(value / scale), -32767L, 32767L));
}

/// Smallest and largest value over order[begin] to order[end - 1].
std::pair<float, float> range_of(const std::vector<float>& values, const Order& order, std::size_t begin,
                                 std::size_t end) {
  float smallest = values[order[begin]], largest = smallest;
  for (std::size_t k = begin; k < end; ++k) {
    smallest = std::min(smallest, values[order[k]]);
    largest = std::max(largest, values[order[k]]);
  }
  return {smallest, largest};
}

void set_coordinates(const PointCloud& points, const Order& order, std::size_t begin, std::size_t end,
                     scan_sector_t& sector) {
  float largest = 1.0f;  // metre: a resolution finer than 1/32767 m has no use
  for (const auto* values : {&points.x, &points.y, &points.z}) {
    const auto [low, high] = range_of(*values, order, begin, end);
    largest = std::max({largest, -low, high});
  }
  sector.coordinate_scale = largest / 32767.0f;
  for (std::size_t k = begin; k < end; ++k) {
    sector.x.push_back(to_count(points.x[order[k]], sector.coordinate_scale));
    sector.y.push_back(to_count(points.y[order[k]], sector.coordinate_scale));
    sector.z.push_back(to_count(points.z[order[k]], sector.coordinate_scale));
  }
}

void set_times(const PointCloud& points, const Order& order, std::size_t begin, std::size_t end,
               scan_sector_t& sector) {
  const auto [first, last] = range_of(points.time, order, begin, end);
  sector.time_origin = 0.5f * (first + last);
  sector.time_scale = std::max(0.5f * (last - first) / 32767.0f, 1e-9f);
  for (std::size_t k = begin; k < end; ++k)
    sector.times.push_back(to_count(points.time[order[k]] - sector.time_origin, sector.time_scale));
  sector.num_times = sector.num_points;
}

void set_intensities(const PointCloud& points, const Order& order, std::size_t begin, std::size_t end,
                     scan_sector_t& sector) {
  const float largest = range_of(points.intensity, order, begin, end).second;
  sector.intensity_scale = largest > 0 && std::isfinite(largest) ? largest / 255.0f : 1.0f;
  for (std::size_t k = begin; k < end; ++k) {
    const float counts = points.intensity[order[k]] / sector.intensity_scale;
    sector.intensities.push_back(
        static_cast<std::uint8_t>(counts > 0 ? std::lround(std::min(counts, 255.0f)) : 0));
  }
  sector.num_intensities = sector.num_points;
}

}  // namespace

std::vector<Bytes> encode_sectors(const Scan& scan, const ScanTags& tags, std::size_t max_bytes) {
  const PointCloud& points = scan.points;
  const Order order = sweep_order(points);
  scan_sector_t empty{};
  empty.utime = scan.utime;
  empty.seq = tags.seq;
  empty.frame_id = wire_string(tags.frame_id).substr(0, 255);
  empty.coordinate_scale = 1;
  const std::size_t overhead = static_cast<std::size_t>(empty.getEncodedSize());
  const std::size_t room = std::max<std::size_t>(max_bytes, 1000) - overhead;
  const std::size_t per_sector = std::max(room / kBytesPerPoint, order.size() / kMaxSectors + 1);
  const std::size_t sector_count = std::max<std::size_t>(1, (order.size() + per_sector - 1) / per_sector);

  std::vector<Bytes> messages;
  for (std::size_t s = 0; s < sector_count; ++s) {
    const std::size_t begin = order.size() * s / sector_count, end = order.size() * (s + 1) / sector_count;
    scan_sector_t sector = empty;
    sector.sector_index = static_cast<std::int16_t>(s);
    sector.sector_count = static_cast<std::int16_t>(sector_count);
    sector.num_points = static_cast<std::int32_t>(end - begin);
    if (begin < end) {
      set_coordinates(points, order, begin, end, sector);
      if (points.has_times()) set_times(points, order, begin, end, sector);
      if (points.has_intensity()) set_intensities(points, order, begin, end, sector);
    }
    messages.push_back(generated_bytes(sector));
  }
  return messages;
}

}  // namespace scanlock
