// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "icp/cloud_problem.hpp"

namespace scanlock {

/// Largest number of points for the medians at the start of an alignment.
inline constexpr std::size_t kMedianPoints = 2048;

/// Section 4.3: nu_max is three times the median residual at the start `pose`, metres. `problem` is left
/// evaluated at that pose.
double nu_max_at(const CentredCloud& source, const CloudTarget& target, const Pose& pose,
                 CloudProblem* problem);

/// The start of an alignment: a pose between the centred frames, and the effort spent on finding it.
struct CloudStart {
  Pose pose = Pose::Identity();
  double nu_max = 0;   ///< metres, at the guess
  int iterations = 0;  ///< as in CloudAlignment
  int sweeps = 0;
  std::int64_t searches_made = 0, searches_saved = 0;
};

/// Moves a guess into the basin of convergence of an alignment with all points. The first nu need few points,
/// but these equally far apart: rows and rings of a scan, dense near the sensor, attract those of the other
/// scan. These levels use distances to points, whose basin is wide, down to the nu from which the method
/// itself continues. Where most of the points then still lie off the target (little overlap, or clutter that
/// outnumbers the surfaces), a second attempt uses every n-th point of the source, and the better of the two
/// poses is returned. `setup`: of the method.
CloudStart approach(const CentredCloud& source, const CloudTarget& target, CloudProblem::Setup setup,
                    const Pose& guess);

}  // namespace scanlock
