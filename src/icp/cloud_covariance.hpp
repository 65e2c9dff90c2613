// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "icp/cloud_problem.hpp"
#include "icp/degeneracy.hpp"

namespace scanlock {

/// How well the pairs of an alignment fix its motion.
struct AlignmentCertainty {
  Matrix6 covariance = Matrix6::Zero();  ///< as in CloudAlignment, in the source's own frame
  Degeneracy degeneracy;
};

/// From the point-to-plane Hessian at the pairs that `problem` evaluated last, whatever its objective: that
/// of point-to-point is no covariance (Bonnabel et al. 2016). Pairs farther apart than `gate` metres do not
/// count. `source_centre`: where the origin of the centred source lies in its own frame.
AlignmentCertainty alignment_certainty(const PointCloud& source, const CloudTarget& target,
                                       const CloudProblem& problem, double gate,
                                       const Eigen::Vector3d& source_centre);

}  // namespace scanlock
