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
  double middle_s = 0;                     ///< seconds from the stamp: middle of the times of the scan
};

/// The predicted state of the body, before the scan is used. The error of a moving pose against it is
/// e = [log(mean.pose^-1 pose); twist - mean.twist; acceleration]. A body moves smoothly most of the time and
/// abruptly now and then, so that e has a multivariate Student t distribution with kPriorFreedom degrees of
/// freedom: the prior has full weight for motions near the prediction, and little for motions that contradict
/// it.
struct MotionPrior {
  MovingPose mean;
  Matrix12 information = Matrix12::Zero();  ///< of pose and twist, inverse scale matrix; positive definite
  /// Power spectral density of the acceleration within the scan, which is white noise of mean zero; m^2/s^3
  /// and rad^2/s^3. Zero: constant twist.
  Vector6 acceleration_density = Vector6::Zero();
  double ahead_s = 0;                          ///< seconds from the state that the mean was predicted from
  Matrix12 transition = Matrix12::Identity();  ///< maps errors of that state to errors of the mean
  Matrix12 noise = Matrix12::Zero();           ///< covariance of the deviation of the motion from the mean
};

inline constexpr double kPriorFreedom = 4;  ///< degrees of freedom, f below

/// Weight of the prior in iteratively reweighted least squares, at s = e^T information e: (f + 12) / (f + s).
/// It is 1 at s = 12, the number of components of pose and twist.
double prior_weight(double squared_error);

/// The negative log-likelihood of the prior at s, up to a constant: (f + 12) / 2 log(1 + s / f).
double prior_cost(double squared_error);

struct ScanProblem;

/// The target of a scan alignment: points in a frame near the sensor (metres), their tree, and their
/// surfaces.
struct AlignmentTarget {
  const PointCloud& cloud;
  const KdForest& tree;
  LocalSurfaces& surfaces;
};

struct ScanAlignmentOptions {
  double nu_min = 0.05;  ///< metres, the last scale of the Welsch kernel
  double nu_first =
      0;  ///< metres, a lower bound of the first scale, which is three times the median residual
  double nu_max = 1.0;  ///< metres, an upper bound of the first scale
  double gate_margin =
      0.5;  ///< metres: a source point pairs with a target point nearer than 3 nu + gate_margin
  double sigma =
      0.1;  ///< metres: standard deviation of a residual against the prior, including its correlations
  double patch = 1.0;       ///< metres: points within one cube of this edge share an error
  bool sided = true;        ///< points pair only with planes whose observed side their ray meets
  int max_iterations = 12;  ///< at the last scale; earlier ones get a third
  double tolerance = 5e-4;  ///< metres, of the motion of the scan's points
  int anderson_window = 5;
  int threads = 1;
};

struct ScanAlignment {
  MovingPose moving;
  Matrix12 information =
      Matrix12::Zero();  ///< of the data alone, order and frame as in MotionPrior, unit residual variance
  /// Information on the pose if the motion within the scan were known; to estimate that motion, too, leaves
  /// less.
  Matrix6 pose_information = Matrix6::Zero();
  Matrix6 noise = Matrix6::Zero();  ///< expected contribution of errors of the normals to pose_information
  /// Ratio of the second derivative of the energy to its Gauss-Newton approximation, mean over the points: 1
  /// where residuals are small against nu, less where many residuals are of the size of nu.
  double curvature = 1;
  /// Covariance of the first derivative of the energy, order and frame as in `information`, units m^2 times
  /// those of `information`. The points of a patch share an error: they count as one.
  Matrix12 scatter = Matrix12::Zero();
  int iterations = 0, evaluations = 0;
  bool converged = false;
  int matched = 0;             ///< source points within the gate of a surface
  double median_residual = 0;  ///< metres, absolute, of the matched points
  std::int64_t searches_made = 0, searches_saved = 0;
};

/// The fit of one source point of an alignment to its surface.
struct PointFit {
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  ///< metres: the point in the target frame
  float explained = 0;  ///< weight of the surface times weight of the kernel; 0: no surface
  Surface surface;
};

/// Robust point-to-plane ICP (algorithm 2) with two extensions: the unknowns are the pose at the stamp *and*
/// velocity and acceleration, so that the motion within the scan is estimated and not only predicted, and a
/// prior connects these to the predicted state. The energy is n - sum_i s_i exp(-r_i^2 / (2 nu^2)) +
/// (sigma^2 / nu_min^2) prior_cost(e^T information e), with s_i the weight of the surface (0 without a
/// surface, or where the ray meets the unobserved side of a plane, see ScanAlignmentOptions::sided) and r_i
/// the distance from the surface times its scale.
class ScanAligner {
 public:
  ScanAligner();
  ~ScanAligner();
  ScanAligner(ScanAligner&&) noexcept;
  ScanAligner& operator=(ScanAligner&&) noexcept;

  /// `source`: points in the body frame, metres, with or without times. Without times, all points are taken
  /// to be measured at the stamp.
  ScanAlignment align(const PointCloud& source, const AlignmentTarget& target, const MotionPrior& prior,
                      const ScanAlignmentOptions& options);

  /// For each source point at the result: the residual (metres), NaN without a surface; the weight of its
  /// surface; and the distance (metres), which is the residual without the scale for planes: near a plane
  /// through clutter, whose scale is low, all residuals are small.
  const std::vector<float>& residuals() const;
  const std::vector<float>& distances() const;
  const std::vector<float>& weights() const;
  /// The fit of each source point at the result; `target`: the one that was passed to align().
  std::vector<PointFit> fits(const AlignmentTarget& target) const;

 private:
  std::unique_ptr<ScanProblem> problem_;
};

/// The points of a scan in the body frame at its stamp: p' = exp(t * twist + bend_at(t) * acceleration) p.
/// A copy if the points have no times.
PointCloud deskewed(const PointCloud& points, const MovingPose& moving);

}  // namespace scanlock
