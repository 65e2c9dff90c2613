// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// What an alignment did, all in the target's frame.
struct AlignmentPicture {
  PointCloud before;  ///< the source where it was given
  PointCloud after;   ///< the source where it ended
  PointCloud target;
  std::string title;
};

/// An SVG picture: from above, from the side and from the front, before in the upper row and after in the
/// lower; the source coloured by its distance to the target. Large clouds are thinned for the eye.
std::string alignment_svg(const AlignmentPicture& picture);

}  // namespace scanlock
