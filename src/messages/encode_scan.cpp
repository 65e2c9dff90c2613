// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/encode_scan.hpp"

#include <algorithm>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/pointcloud_t.hpp>
#include <cmath>
#include <cstring>
#include <drake/lcmt_point_cloud.hpp>
#include <sensor_msgs/PointCloud2.hpp>

#include "geometry/elementary.hpp"
#include "messages/generated_bytes.hpp"
#include "messages/packed_cloud.hpp"

namespace scanlock {
namespace {

/// An array of a cloud that is sent as float32. columns_of() gives them in the order of the message's fields.
struct Column {
  const char* name;
  const std::vector<float>* values;
};

std::vector<Column> columns_of(const PointCloud& points) {
  std::vector<Column> columns = {{"x", &points.x}, {"y", &points.y}, {"z", &points.z}};
  if (points.has_intensity()) columns.push_back({"intensity", &points.intensity});
  if (points.has_times()) columns.push_back({"t", &points.time});
  return columns;
}

void store_little_endian(float value, std::uint8_t* to) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  for (int i = 0; i < 4; ++i) to[i] = static_cast<std::uint8_t>(bits >> 8 * i);
}

std::vector<std::uint8_t> packed(const std::vector<Column>& columns, std::size_t count) {
  const std::size_t step = 4 * columns.size();
  std::vector<std::uint8_t> data(count * step);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < count; ++i)
      store_little_endian((*columns[c].values)[i], &data[i * step + 4 * c]);
  return data;
}

}  // namespace

Bytes encode_pointcloud2(const Scan& scan, const ScanTags& tags) {
  const std::vector<Column> columns = columns_of(scan.points);
  bot_core::pointcloud2_t message{};
  message.utime = scan.utime;
  message.seq = tags.seq;
  message.frame_id = wire_string(tags.frame_id);
  message.height = 1;
  message.width = static_cast<std::int32_t>(scan.points.size());
  for (const Column& column : columns) {
    bot_core::pointfield_t field{};
    field.name = column.name;
    field.offset = static_cast<std::int32_t>(4 * message.fields.size());
    field.datatype = kFloat32Datatype;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.nfields = static_cast<std::int32_t>(message.fields.size());
  message.point_step = 4 * message.nfields;
  message.row_step = message.point_step * message.width;
  message.data = packed(columns, scan.points.size());
  message.data_nbytes = static_cast<std::int32_t>(message.data.size());
  message.is_dense = 1;
  return generated_bytes(message);
}

Bytes encode_ros_pointcloud2(const Scan& scan, const ScanTags& tags) {
  const std::vector<Column> columns = columns_of(scan.points);
  sensor_msgs::PointCloud2 message{};
  message.header.seq = tags.seq;
  message.header.stamp.sec = static_cast<std::int32_t>(scan.utime / 1000000);
  message.header.stamp.nsec = static_cast<std::int32_t>(scan.utime % 1000000 * 1000);
  message.header.frame_id = wire_string(tags.frame_id);
  message.height = 1;
  message.width = static_cast<std::int32_t>(scan.points.size());
  for (const Column& column : columns) {
    sensor_msgs::PointField field{};
    field.name = column.name;
    field.offset = static_cast<std::int32_t>(4 * message.fields.size());
    field.datatype = kFloat32Datatype;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.fields_length = static_cast<std::int32_t>(message.fields.size());
  message.point_step = 4 * message.fields_length;
  message.row_step = message.point_step * message.width;
  message.data = packed(columns, scan.points.size());
  message.data_length = static_cast<std::int32_t>(message.data.size());
  message.is_dense = 1;
  return generated_bytes(message);
}

Bytes encode_drake_point_cloud(const Scan& scan, const ScanTags& tags) {
  constexpr std::int64_t kFiniteFlag = 2;
  const std::vector<Column> columns = columns_of(scan.points);
  drake::lcmt_point_cloud message{};
  message.utime = scan.utime;
  message.frame_name = wire_string(tags.frame_id);
  message.width = static_cast<std::int64_t>(scan.points.size());
  message.height = 1;
  for (const Column& column : columns) {
    drake::lcmt_point_cloud_field field{};
    field.name = column.name;
    field.byte_offset = static_cast<std::int32_t>(4 * message.fields.size());
    field.datatype = kFloat32Datatype;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.num_fields = static_cast<std::int32_t>(message.fields.size());
  message.flags = kFiniteFlag;
  message.point_step = 4 * message.num_fields;
  message.row_step = message.point_step * message.width;
  message.data = packed(columns, scan.points.size());
  message.data_size = static_cast<std::int64_t>(message.data.size());
  return generated_bytes(message);
}

Bytes encode_pointcloud(const Scan& scan, const ScanTags& tags) {
  const PointCloud& points = scan.points;
  bot_core::pointcloud_t message{};
  message.utime = scan.utime;
  message.seq = tags.seq;
  message.frame_id = wire_string(tags.frame_id);
  message.n_points = static_cast<std::int32_t>(points.size());
  message.points.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    message.points.push_back({points.x[i], points.y[i], points.z[i]});
  if (points.has_intensity()) {
    message.channel_names.emplace_back("intensity");
    message.channels.push_back(points.intensity);
  }
  if (points.has_times()) {
    message.channel_names.emplace_back("t");
    message.channels.push_back(points.time);
  }
  message.n_channels = static_cast<std::int32_t>(message.channels.size());
  return generated_bytes(message);
}

Bytes encode_planar_lidar(const Scan& scan, int beams, double half_height_m) {
  const PointCloud& points = scan.points;
  const int count = std::max(beams, 1);
  const double step = 2 * M_PI / count;
  bot_core::planar_lidar_t message{};
  message.utime = scan.utime;
  message.nranges = count;
  message.ranges.assign(static_cast<std::size_t>(count), 0.0f);
  if (points.has_intensity()) {
    message.nintensities = count;
    message.intensities.assign(static_cast<std::size_t>(count), 0.0f);
  }
  message.rad0 = static_cast<float>(-M_PI);
  message.radstep = static_cast<float>(step);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float range = hypot(points.x[i], points.y[i]);
    if (!(std::abs(points.z[i]) <= half_height_m) || !std::isfinite(range) || range == 0) continue;
    const double angle = atan2(points.y[i], points.x[i]) + M_PI;
    const auto beam = static_cast<std::size_t>(std::lround(angle / step) % count);
    if (message.ranges[beam] != 0 && message.ranges[beam] <= range) continue;
    message.ranges[beam] = range;
    if (points.has_intensity()) message.intensities[beam] = points.intensity[i];
  }
  return generated_bytes(message);
}

}  // namespace scanlock
