// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "geometry/point_cloud.hpp"
#include "io/byte_source.hpp"
#include "odometry/keyframe_points.hpp"

namespace scanlock {

/// Decodes coordinates in steps of 2^exponent metres, int16: all x, then all y, then all z.
PointCloud decoded_points(std::string_view bytes, int exponent);

/// The points of a keyframe in a map file.
class PointsInFile : public StoredPoints {
 public:
  struct Part {
    std::size_t offset = 0, count = 0;    ///< offset in bytes, number of points
    int exponent = 0;                     ///< of the step, 2^exponent metres
    std::uint32_t before = 0, after = 0;  ///< CRC-32 of the file before the points, and up to their end
  };
  PointsInFile(std::shared_ptr<const InputFile> file, const Part& part)
      : file_(std::move(file)), part_(part) {}

  std::size_t size() const override { return part_.count; }
  /// Throws PointsUnreadable when the file has been modified in place since the map was loaded.
  PointCloud read() const override;

 private:
  const std::shared_ptr<const InputFile> file_;
  const Part part_;
};

}  // namespace scanlock
