// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <vector>

#include "io/cloud_columns.hpp"
#include "io/cloud_formats.hpp"

namespace scanlock {

void parse_kitti_bin(const std::string& path, ByteSource& source, const PointSink& sink) {
  constexpr std::size_t kPointSize = 16;
  const std::size_t bytes = source.left(), points = bytes / kPointSize;
  if (points * kPointSize != bytes)
    fail_at_byte(path, points * kPointSize,
                 "the file ends within a point (" + std::to_string(bytes) +
                     " bytes are no multiple of 16): cut short, or not a KITTI scan");
  CloudTable table({&PointCloud::x, &PointCloud::y, &PointCloud::z, &PointCloud::intensity}, points, sink);
  for (std::size_t i = 0; i < points; ++i) {
    const auto* const point = reinterpret_cast<const std::uint8_t*>(source.peek(kPointSize).data());
    for (std::size_t c = 0; c < 4; ++c) table.set(c, read_scalar(point + 4 * c, ScalarType::kFloat32, false));
    source.skip(kPointSize);
    table.end_point();
  }
  table.hand_on();
}

std::string format_kitti_bin(const PointCloud& cloud) {
  const std::vector<float> zeros(cloud.has_intensity() ? 0 : cloud.size());
  std::string bytes;
  append_rows(bytes, {{"x", &cloud.x},
                      {"y", &cloud.y},
                      {"z", &cloud.z},
                      {"intensity", cloud.has_intensity() ? &cloud.intensity : &zeros}});
  return bytes;
}

}  // namespace scanlock
