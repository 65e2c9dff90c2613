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

/// Coordinates as steps of 2^exponent metres: all x, then all y, then all z, of 2 bytes each.
PointCloud decoded_points(std::string_view bytes, int exponent);

/// The points of a keyframe in a map file.
class PointsInFile : public StoredPoints {
 public:
  struct Part {
    std::size_t offset = 0, count = 0;    ///< bytes, points
    int exponent = 0;                     ///< of the step
    std::uint32_t before = 0, after = 0;  ///< checksums of the file up to its begin and up to its end
  };
  PointsInFile(std::shared_ptr<const InputFile> file, const Part& part)
      : file_(std::move(file)), part_(part) {}

  std::size_t size() const override { return part_.count; }
  /// A file may be written over while it is open: what is there now need not be what was loaded.
  PointCloud read() const override;

 private:
  const std::shared_ptr<const InputFile> file_;
  const Part part_;
};

}  // namespace scanlock
