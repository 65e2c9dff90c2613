// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// The result of an alignment; all clouds are in the target's frame.
struct AlignmentPicture {
  PointCloud before;  ///< the source at its initial pose
  PointCloud after;   ///< the source at its final pose
  PointCloud target;
  std::string title;
};

/// An SVG picture with views from above, from the side and from the front; the upper row shows the source
/// before, the lower row after the alignment, coloured by its distance to the target. Large clouds are
/// thinned for display.
std::string alignment_svg(const AlignmentPicture& picture);

}  // namespace scanlock
