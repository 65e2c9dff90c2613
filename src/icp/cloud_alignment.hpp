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

/// A method of the paper: which energy, and whether and how its descent is accelerated.
struct CloudMethod {
  IcpObjective objective = IcpObjective::kPoint;
  bool robust = true;  ///< Welsch's function with a falling nu; else squares
  bool accelerated = true;
  MotionCoordinates coordinates = MotionCoordinates::kLieAlgebra;

  bool needs_normals() const { return objective != IcpObjective::kPoint; }
};

/// icp, aa-icp, fast-icp, robust-icp, icp-plane, fast-icp-plane, robust-icp-plane, symmetric-icp,
/// robust-symmetric-icp; nothing for another name.
std::optional<CloudMethod> find_cloud_method(const std::string& name);
std::vector<std::string> cloud_method_names();

struct CloudAlignmentOptions {
  double nu_max = 0;       ///< metres; 0: three times the median residual at the start
  double nu_min = 0;       ///< metres; 0: the target's own
  int max_iterations = 0;  ///< a level; 0: 1000 without a robust function, 100 with one
  double tolerance = 0;  ///< metres of motion of a typical point; 0: 1e-5 of the target's diagonal, and less
                         ///< for a small nu_min
  double voxel = 0;      ///< metres that both clouds were thinned to; 0: they are whole
  /// For robust distances to points, from a start that may be good already: rows and rings hold on to those
  /// of the other scan, and can carry it off. Where the start lies closer on the target's tangent planes it
  /// is kept, stop_reason "start", and only brought to rest on them. Takes a target whose normals are
  /// prepared.
  bool start_may_be_better = false;
  bool thorough = false;                 ///< all points and the final tolerance at every nu, as in the paper
  int threads = 1;                       ///< does not change the result
  std::function<void(double)> progress;  ///< called now and then with the share that is done, 0 to 1
};

struct CloudAlignment {
  Pose target_from_source = Pose::Identity();  ///< in the clouds' own frames; always finite
  std::string stop_reason;                     ///< converged, iterations, degenerate, start
  double energy = 0;                           ///< at the last nu, over the points of the source
  double inlier_ratio = 0;                     ///< share of the source within two spacings of the target
  double nu_max = 0, nu_min = 0;
  int iterations = 0;  ///< accepted steps
  int sweeps = 0;      ///< passes over the source, or the share of it that a level uses
  std::int64_t searches_made = 0, searches_saved = 0;
  /// Of xi in target_from_source exp(xi), [translation; rotation] in the source's frame, metres and radians.
  Matrix6 covariance = Matrix6::Zero();
  std::uint32_t degenerate_axes = 0;  ///< bits as in Degeneracy, axes of the source's frame
};

/// Registers `source` to `target` from the guess `start`. Points that are not finite are left out; throws
/// std::invalid_argument when fewer than three are left. Normals that the source brings are used where the
/// method does; where they are missing they are estimated. A scene that leaves motions open gives those as
/// degenerate_axes, and along them the guess. Reproducible: one and the same result on any number of threads.
CloudAlignment align_clouds(const PointCloud& source, const CloudTarget& target, const Pose& start,
                            const CloudMethod& method, const CloudAlignmentOptions& options = {});

/// Median distance, metres, of the moved source to the target, over a sample of points: which of two guesses
/// is the better one. Throws as align_clouds() does.
double misfit(const PointCloud& source, const CloudTarget& target, const Pose& guess);

}  // namespace scanlock
