// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid.hpp"
#include "icp/cloud_problem.hpp"
#include "icp/cloud_target.hpp"

namespace scanlock {

/// A method of the paper: its energy, and whether and in which coordinates its descent is accelerated.
struct CloudMethod {
  IcpObjective objective = IcpObjective::kPoint;
  bool robust = true;  ///< Welsch's function with a decreasing nu; else squares
  bool accelerated = true;
  MotionCoordinates coordinates = MotionCoordinates::kLieAlgebra;

  bool needs_normals() const { return objective != IcpObjective::kPoint; }
};

/// icp, aa-icp, fast-icp, robust-icp, icp-plane, fast-icp-plane, robust-icp-plane, symmetric-icp,
/// robust-symmetric-icp; nullopt for any other name.
std::optional<CloudMethod> find_cloud_method(const std::string& name);
std::vector<std::string> cloud_method_names();

struct CloudAlignmentOptions {
  double nu_max = 0;       ///< metres; 0: three times the median residual at the start
  double nu_min = 0;       ///< metres; 0: derived from the target
  int max_iterations = 0;  ///< at each nu; 0: 1000 for squares, 100 for a robust method
  double tolerance = 0;  ///< metres of motion of a typical point; 0: 1e-5 of the target's diagonal, and less
                         ///< for a small nu_min
  double voxel = 0;      ///< metres: the voxel that both clouds were thinned by; 0: not thinned
  /// For the robust point-to-point method, from a start that may be good already: rows and rings of the
  /// source attract those of the target, and can pull the pose away from it. Keeps the start, stop_reason
  /// "start", where its distances to the target's tangent planes have the lower energy. The pose that is kept
  /// is then refined by distances to these planes. Requires a target with prepared normals.
  bool start_may_be_better = false;
  bool thorough = false;                 ///< all points and the final tolerance at every nu, as in the paper
  int threads = 1;                       ///< does not change the result
  std::function<void(double)> progress;  ///< called repeatedly with the share of the work done, 0 to 1
};

struct CloudAlignment {
  Pose target_from_source = Pose::Identity();  ///< in the clouds' own frames; always finite
  std::string stop_reason;                     ///< converged, iterations, degenerate, start
  double energy = 0;                           ///< at the last nu, over the points of the source
  double inlier_ratio = 0;        ///< share of source points within max(2 spacings, 6 nu_min) of the target
  double nu_max = 0, nu_min = 0;  ///< metres
  int iterations = 0;             ///< accepted steps
  int sweeps = 0;                 ///< passes over the source points that a level uses
  std::int64_t searches_made = 0, searches_saved = 0;  ///< nearest neighbour searches, see Correspondences
  /// Covariance of xi in target_from_source exp(xi), [translation; rotation] in the source's frame, metres
  /// and radians.
  Matrix6 covariance = Matrix6::Zero();
  std::uint32_t degenerate_axes = 0;  ///< bits as in Degeneracy, axes of the source's frame
};

/// Registers `source` to `target` from the guess `start`. Points that are not finite are left out. Throws
/// std::invalid_argument when fewer than three are left, or when the method requires normals that the target
/// has not prepared. The symmetric objective uses the normals of the source, and estimates missing ones.
/// Motions that the scene does not constrain are reported as degenerate_axes; along them the result stays at
/// the guess. The result is the same for any number of threads.
CloudAlignment align_clouds(const PointCloud& source, const CloudTarget& target, const Pose& start,
                            const CloudMethod& method, const CloudAlignmentOptions& options = {});

/// Median distance, metres, of the moved source to the target, over a sample of points: the better of two
/// guesses has the smaller one. Throws like align_clouds().
double misfit(const PointCloud& source, const CloudTarget& target, const Pose& guess);

}  // namespace scanlock
