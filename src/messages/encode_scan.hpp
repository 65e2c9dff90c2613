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

/// Members that most scan types have besides the points.
struct ScanTags {
  std::int32_t seq = 0;
  std::string frame_id = "body";
};

/// bot_core.pointcloud2_t: x y z as float32 (little endian), then `intensity` and `t` (float32, seconds
/// relative to the stamp) if the cloud has them.
Bytes encode_pointcloud2(const Scan& scan, const ScanTags& tags = {});
/// The same points as sensor_msgs.PointCloud2. The stamp has microsecond resolution.
Bytes encode_ros_pointcloud2(const Scan& scan, const ScanTags& tags = {});
/// The same points as drake.lcmt_point_cloud, which has no sequence number.
Bytes encode_drake_point_cloud(const Scan& scan, const ScanTags& tags = {});
/// bot_core.pointcloud_t with channels `intensity` and `t` if the cloud has them.
Bytes encode_pointcloud(const Scan& scan, const ScanTags& tags = {});

/// bot_core.planar_lidar_t: `beams` equal steps of a full turn, starting at -pi rad. Each beam gets the
/// nearest point within `half_height_m` of the plane z = 0, or range 0 when no point is there. The times of
/// points are lost: the type has no member for them.
Bytes encode_planar_lidar(const Scan& scan, int beams = 1440, double half_height_m = 0.2);

/// scanlock.scan_sector_t: the points, sorted by time (by azimuth when the cloud has no times) and cut into
/// messages of at most `max_bytes` (at least 1000). Coordinates are rounded to multiples of 1/32767 of the
/// largest coordinate in the sector: an error of at most 2 mm at 130 m. A scan without points gives one
/// sector without points. Points with a coordinate above 3 km, or more than 50 s from the stamp, are left
/// out.
std::vector<Bytes> encode_sectors(const Scan& scan, const ScanTags& tags = {}, std::size_t max_bytes = 60000);

}  // namespace scanlock
