// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "messages/encode.hpp"

namespace scanlock {

/// What accompanies a scan in most types.
struct ScanTags {
  std::int32_t seq = 0;
  std::string frame_id = "body";
};

/// bot_core.pointcloud2_t: x y z as float32 (little endian), then `intensity` and `t` (float32, seconds
/// relative to the stamp) where the cloud has them.
Bytes encode_pointcloud2(const Scan& scan, const ScanTags& tags = {});
/// The same points as sensor_msgs.PointCloud2. The stamp keeps microseconds.
Bytes encode_ros_pointcloud2(const Scan& scan, const ScanTags& tags = {});
/// The same points as drake.lcmt_point_cloud, which has no sequence number.
Bytes encode_drake_point_cloud(const Scan& scan, const ScanTags& tags = {});
/// bot_core.pointcloud_t with channels `intensity` and `t` where the cloud has them.
Bytes encode_pointcloud(const Scan& scan, const ScanTags& tags = {});

/// bot_core.planar_lidar_t: `beams` equal steps of the full turn, beginning at -pi; in each the nearest point
/// that lies within `half_height_m` of the sensor's plane. A beam without one has range 0. Times are lost:
/// the type has none.
Bytes encode_planar_lidar(const Scan& scan, int beams = 1440, double half_height_m = 0.2);

/// scanlock.scan_sector_t: the points ordered by time (by azimuth when there are no times) and cut into
/// messages of at most `max_bytes` (at least 1000). Coordinates are rounded to 1/32767 of the largest in the
/// sector: 2 mm at 130 m. A scan without points is one sector without points. Points farther than 3 km or 50
/// s from the stamp are left out.
std::vector<Bytes> encode_sectors(const Scan& scan, const ScanTags& tags = {}, std::size_t max_bytes = 60000);

}  // namespace scanlock
