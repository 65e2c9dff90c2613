// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "geometry/linear.hpp"
#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "icp/local_surfaces.hpp"
#include "search/kd_forest.hpp"

namespace scanlock {

/// A pose and its velocity: during a scan the body moves as pose * exp(t * twist + bend_at(t) *
/// acceleration), t in seconds from the stamp.
struct MovingPose {
  Pose pose = Pose::Identity();            ///< target_from_body at the stamp
  Vector6 twist = Vector6::Zero();         ///< body velocity [m/s; rad/s], the mean over the scan
  Vector6 acceleration = Vector6::Zero();  ///< m/s^2, rad/s^2
  double middle_s = 0;                     ///< of the times of the scan
};

/// What is known before the scan is looked at. The error of a moving pose against it is
/// e = [log(mean.pose^-1 pose); twist - mean.twist; acceleration]. A body moves smoothly most of the time and
/// abruptly now and then, so that e has a multivariate Student t distribution with kPriorFreedom degrees of
/// freedom: what follows the prediction is held by it, what contradicts it is let go.
struct MotionPrior {
  MovingPose mean;
  Matrix12 information = Matrix12::Zero();  ///< of pose and twist, inverse scale matrix; positive definite
  /// Power spectral density of the acceleration within the scan, which is white noise of mean zero; m^2/s^3
  /// and rad^2/s^3. Zero: a straight way.
  Vector6 acceleration_density = Vector6::Zero();
  double ahead_s = 0;                          ///< seconds since the state that it was predicted from
  Matrix12 transition = Matrix12::Identity();  ///< of errors of that state to errors of the mean
  Matrix12 noise = Matrix12::Zero();  ///< covariance of what the motion may have been beyond the mean
};

inline constexpr double kPriorFreedom = 4;

/// Weight of the prior in iteratively reweighted least squares, at s = e^T information e: (f + 12) / (f + s).
/// One where the error is what the information says.
double prior_weight(double squared_error);

/// The negative log-likelihood of the prior at s, but for a constant: (f + 12) / 2 log(1 + s / f).
double prior_cost(double squared_error);

struct ScanProblem;

/// What a scan is aligned with: points in a frame near the sensor, their tree, and their surfaces.
struct AlignmentTarget {
  const PointCloud& cloud;
  const KdForest& tree;
  LocalSurfaces& surfaces;
};

struct ScanAlignmentOptions {
  double nu_min = 0.05;  ///< metres, the last scale of the Welsch kernel
  double nu_first =
      0;  ///< metres, a lower bound of the first scale, which is three times the median residual
  double nu_max = 1.0;  ///< metres, an upper bound of it
  double gate_margin =
      0.5;  ///< metres: a source point pairs with a target point nearer than 3 nu + gate_margin
  double sigma =
      0.1;  ///< metres: standard deviation of a residual against the prior, its correlations counted in
  double patch = 1.0;       ///< metres: points of one cube of this edge share an error
  bool sided = true;        ///< a ray meets a plane from the side only that the target was seen from
  int max_iterations = 12;  ///< at the last scale; earlier ones get a third
  double tolerance = 5e-4;  ///< metres, of the motion of the scan's points
  int anderson_window = 5;
  int threads = 1;
};

struct ScanAlignment {
  MovingPose moving;
  Matrix12 information =
      Matrix12::Zero();  ///< of the data alone, order and frame as in MotionPrior, unit residual variance
  /// Of the pose alone, were the motion within the scan known: less of it is known where that is solved
  /// along.
  Matrix6 pose_information = Matrix6::Zero();
  Matrix6 noise = Matrix6::Zero();  ///< what errors of the normals alone put into pose_information, expected
  /// The second derivative of the energy over the Gauss-Newton one, the mean over the points: one where
  /// residuals are small against nu, less where many have left the kernel's core.
  double curvature = 1;
  /// Covariance of the first derivative of the energy, order and frame as those of `information`; m^2 times
  /// those of it. The points of a patch share an error: they count as one.
  Matrix12 scatter = Matrix12::Zero();
  int iterations = 0, evaluations = 0;
  bool converged = false;
  int matched = 0;             ///< source points within the gate of a surface
  double median_residual = 0;  ///< metres, of the matched ones
  std::int64_t searches_made = 0, searches_saved = 0;
};

/// How one source point of an alignment lies on its surface.
struct PointFit {
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  ///< of the point, axes of the map
  float explained = 0;  ///< the surface's weight times the kernel's; 0: no surface
  Surface surface;
};

/// Robust point-to-plane ICP (algorithm 2) with two extensions: the unknown is the pose at the stamp *and*
/// velocity and acceleration, so that the motion within the scan is solved and not only predicted, and the
/// prior joins them to the past. The energy is n - sum_i s_i exp(-r_i^2 / (2 nu^2)) + (sigma^2 / nu^2)
/// prior_cost(e^T information e), with s_i the weight of the surface (0 where there is none, or where the ray
/// meets the other side of a plane, see ScanAlignmentOptions::sided), r_i the distance from it times its
/// scale.
class ScanAligner {
 public:
  ScanAligner();
  ~ScanAligner();
  ScanAligner(ScanAligner&&) noexcept;
  ScanAligner& operator=(ScanAligner&&) noexcept;

  /// `source`: points in the body frame, with or without times. Without times all are taken to be seen at the
  /// stamp.
  ScanAlignment align(const PointCloud& source, const AlignmentTarget& target, const MotionPrior& prior,
                      const ScanAlignmentOptions& options);

  /// Of the source points at the result: residuals (metres), NaN where a point found no surface; the weights
  /// of the surfaces; and distances, which are the residuals, but not scaled at planes: whatever lies near a
  /// plane through clutter has a small residual.
  const std::vector<float>& residuals() const;
  const std::vector<float>& distances() const;
  const std::vector<float>& weights() const;
  /// How its source points lie at the result, on the target that they were aligned to.
  std::vector<PointFit> fits(const AlignmentTarget& target) const;

 private:
  std::unique_ptr<ScanProblem> problem_;
};

/// The points of a scan as they stood at its stamp: p' = exp(t * twist + bend_at(t) * acceleration) p.
/// Without times a copy.
PointCloud deskewed(const PointCloud& points, const MovingPose& moving);

}  // namespace scanlock
