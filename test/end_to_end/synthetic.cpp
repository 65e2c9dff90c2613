// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "synthetic.hpp"

#include <algorithm>
#include <bot_core/pose_t.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace scanlock::test {
namespace {

struct Box {
  double min[3], max[3];
};

/// Houses of different depths and heights along both sides, and some cars.
std::vector<Box> street() {
  std::vector<Box> boxes;
  for (int i = -6; i < 10; ++i) {
    const double x = 9.0 * i, deep = 1.5 * ((i * 7 % 5 + 5) % 5);
    boxes.push_back({{x, 8 + deep, -2}, {x + 7, 30, 4.0 + deep}});
    boxes.push_back({{x + 3, -30, -2}, {x + 9, -7 - deep, 7 - deep}});
    if (i % 2 == 0) boxes.push_back({{x + 1, 3.2, -1.7}, {x + 5.2, 5, -0.2}});
  }
  return boxes;
}

/// Distance along the ray to the box; infinite when it passes by.
double distance_to(const Box& box, const double origin[3], const double inverse[3]) {
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - origin[axis]) * inverse[axis],
                 b = (box.max[axis] - origin[axis]) * inverse[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far && near > 0 ? near : std::numeric_limits<double>::infinity();
}

double range_along(const std::vector<Box>& boxes, const double origin[3], const double direction[3]) {
  const double inverse[3] = {1 / direction[0], 1 / direction[1], 1 / direction[2]};
  double range =
      direction[2] < -1e-6 ? -1.7 / direction[2] : std::numeric_limits<double>::infinity();  // the ground
  for (const auto& box : boxes) range = std::min(range, distance_to(box, origin, inverse));
  return range;
}

void append_big_endian(std::string& out, std::uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(value >> (8 * i) & 0xff);
}

std::uint64_t big_endian(const std::uint8_t* from, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | from[i];
  return value;
}

constexpr double kPi = 3.14159265358979323846;

}  // namespace

Place place_on_drive(int scan) {
  const double t = scan / 10.0, turn = 0.1, speed = 8;  // along an arc
  return {speed / turn * std::sin(turn * t), speed / turn * (1 - std::cos(turn * t)), turn * t};
}

bot_core::pointcloud2_t scan_from(const Place& place, std::int64_t utime, int rings, int columns) {
  static const std::vector<Box> boxes = street();
  std::vector<float> values;
  const double origin[3] = {place.x, place.y, 0};
  for (int column = 0; column < columns; ++column) {
    const double azimuth = 2 * kPi * column / columns;
    for (int ring = 0; ring < rings; ++ring) {
      const double elevation = (-25.0 + 40.0 * ring / std::max(rings - 1, 1)) * kPi / 180;
      const double unit[3] = {std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
      const double direction[3] = {std::cos(elevation) * std::cos(azimuth + place.yaw),
                                   std::cos(elevation) * std::sin(azimuth + place.yaw), unit[2]};
      double range = range_along(boxes, origin, direction);
      if (range > 100) range = std::numeric_limits<double>::quiet_NaN();  // no return
      range += 0.01 * std::sin(12.9898 * column + 78.233 * ring);         // a little unevenness
      for (const double u : unit) values.push_back(static_cast<float>(range * u));
      values.push_back(0.5f);  // intensity
    }
  }
  bot_core::pointcloud2_t scan;
  scan.utime = utime;
  scan.seq = 0;
  scan.height = rings;
  scan.width = columns;
  const char* const names[] = {"x", "y", "z", "intensity"};
  for (int i = 0; i < 4; ++i) {
    bot_core::pointfield_t field;
    field.name = names[i];
    field.offset = 4 * i;
    field.datatype = 7;
    field.count = 1;
    scan.fields.push_back(field);
  }
  scan.nfields = 4;
  scan.is_bigendian = 0;
  scan.point_step = 16;
  scan.row_step = 16 * columns;
  scan.data_nbytes = static_cast<std::int32_t>(values.size() * sizeof(float));
  scan.data.resize(values.size() * sizeof(float));
  std::memcpy(scan.data.data(), values.data(), scan.data.size());
  scan.is_dense = 0;
  return scan;
}

void write_log(const std::string& path, const std::vector<Event>& events) {
  std::ofstream file(path, std::ios::binary);
  std::uint64_t number = 0;
  for (const auto& event : events) {
    std::string header;
    append_big_endian(header, 0xEDA1DA01, 4);
    append_big_endian(header, number++, 8);
    append_big_endian(header, static_cast<std::uint64_t>(event.utime), 8);
    append_big_endian(header, event.channel.size(), 4);
    append_big_endian(header, event.data.size(), 4);
    file << header << event.channel;
    file.write(reinterpret_cast<const char*>(event.data.data()),
               static_cast<std::streamsize>(event.data.size()));
  }
  if (!file) throw std::runtime_error("cannot write " + path);
}

std::vector<Event> read_log(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<Event> events;
  std::uint8_t header[28];
  while (file.read(reinterpret_cast<char*>(header), sizeof header) && big_endian(header, 4) == 0xEDA1DA01) {
    Event event;
    event.utime = static_cast<std::int64_t>(big_endian(header + 12, 8));
    event.channel.resize(big_endian(header + 20, 4));
    event.data.resize(big_endian(header + 24, 4));
    file.read(event.channel.data(), static_cast<std::streamsize>(event.channel.size()));
    file.read(reinterpret_cast<char*>(event.data.data()), static_cast<std::streamsize>(event.data.size()));
    if (file) events.push_back(std::move(event));
  }
  return events;
}

std::map<std::int64_t, Place> poses_in(const std::vector<Event>& events, const std::string& channel) {
  std::map<std::int64_t, Place> poses;
  for (const auto& event : events) {
    bot_core::pose_t pose;
    if (event.channel != channel ||
        pose.decode(event.data.data(), 0, static_cast<int>(event.data.size())) < 0)
      continue;
    poses[pose.utime] = {pose.pos[0], pose.pos[1], 2 * std::atan2(pose.orientation[3], pose.orientation[0])};
  }
  return poses;
}

std::int64_t utime_of(int scan) {
  return kFirstUtime + 100000 * scan;
}

std::vector<Event> drive(int scans, int rings, int columns) {
  std::vector<Event> events;
  for (int i = 0; i < scans; ++i) {
    events.push_back(
        {utime_of(i), "LIDAR", bytes_of(scan_from(place_on_drive(i), utime_of(i), rings, columns))});
  }
  return events;
}

double worst_error(const std::map<std::int64_t, Place>& poses, int scans) {
  double worst = 0;
  for (int i = 0; i < scans; ++i) {
    const auto pose = poses.find(utime_of(i));
    if (pose == poses.end()) continue;
    const Place truth =
        place_on_drive(i);  // the drive begins at the origin, looking along x, as the map's frame
    worst = std::max(worst, std::hypot(pose->second.x - truth.x, pose->second.y - truth.y));
  }
  return worst;
}

}  // namespace scanlock::test
