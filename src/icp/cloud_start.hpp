// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "icp/cloud_problem.hpp"

namespace scanlock {

/// The points over which the medians of the start are taken, at most.
inline constexpr std::size_t kMedianPoints = 2048;

/// Section 4.3: nu_max is three times the median residual at the start, metres. The problem is left there.
double nu_max_at(const CentredCloud& source, const CloudTarget& target, const Pose& pose,
                 CloudProblem* problem);

/// Where an alignment begins: a pose between the centred frames, and what it took to find.
struct CloudStart {
  Pose pose = Pose::Identity();
  double nu_max = 0;   ///< metres, at the guess
  int iterations = 0;  ///< as in CloudAlignment
  int sweeps = 0;
  std::int64_t searches_made = 0, searches_saved = 0;
};

/// Brings a guess into the basin of an alignment with all points. The first nu need few points, but equally
/// far apart: rows and rings of a scan, dense near the sensor, hold on to those of the other. They go by
/// distances to points, whose basin is wide, down to a nu where the method itself takes over. Where most of
/// the points then still lie off the target (little overlap, or clutter that fills the room and outweighs the
/// surfaces), points chosen evenly over the source have a try too, and the better one goes on. `setup`: of
/// the method.
CloudStart approach(const CentredCloud& source, const CloudTarget& target, CloudProblem::Setup setup,
                    const Pose& guess);

}  // namespace scanlock
