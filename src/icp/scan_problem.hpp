// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "icp/correspondences.hpp"
#include "icp/robust_icp.hpp"
#include "icp/scan_alignment.hpp"
#include "icp/scan_motion.hpp"

namespace scanlock {

/// The energy of a scan alignment, see ScanAligner, as a DescentProblem.
/// State x = [log(prior^-1 pose); (twist - prior twist) * T; acceleration * T^2 / 8], T the duration of the
/// scan: all in metres and radians. The state of a scan without times has no acceleration, which it cannot
/// observe.
struct ScanProblem final : DescentProblem {
  // Inputs of the alignment under way; set by begin().
  const PointCloud* source = nullptr;
  const AlignmentTarget* target = nullptr;
  const MotionPrior* prior = nullptr;
  const ScanAlignmentOptions* options = nullptr;

  ScanMotion motion;
  Correspondences correspondences;
  double nu = 1.0;
  double duration = 0.1;  // seconds: converts a velocity to a displacement
  double arm = 10.0;      // metres: converts a rotation to the displacement of a typical point
  Vector6 x = Vector6::Zero(), twist = Vector6::Zero(), acceleration = Vector6::Zero();
  Matrix18 held = Matrix18::Zero();               // information of the prior
  std::vector<float> wx, wy, wz;                  // source in the target frame
  Eigen::Vector3f eye = Eigen::Vector3f::Zero();  // sensor origin at the stamp, target frame, metres
  // Per source point; NaN (weights: 0) without a surface; see ScanAligner.
  std::vector<float> distances, residuals, weights;
  std::vector<double> kernel;  // Welsch's weight of the residual, where there is a surface
  int matched = 0;

  void begin(const PointCloud& cloud, const AlignmentTarget& to, const MotionPrior& from,
             const ScanAlignmentOptions& with);
  int unknowns() const { return motion.still() ? 12 : 18; }

  double gate() const { return 3.0 * nu + options->gate_margin; }

  MovingPose moving(const StateVector& state) const;
  double evaluate(const StateVector& state) override;
  StateVector image() override;
  double distance(const StateVector& a, const StateVector& b) const override;
  /// Computes the residuals at the current correspondences; returns the energy.
  double measure();
  double median_absolute_residual() const;

  // ---- uncertainty of the result: scan_uncertainty.cpp

  /// Sets information and scatter of pose and twist, with the acceleration marginalised: its uncertainty
  /// lowers the information on both.
  void tell(ScanAlignment* result) const;
  /// The second derivative of Welsch's function, w (1 - r^2 / nu^2) along a residual and w across it, over w.
  double curvature() const;
  /// Expected contribution of errors of the surfaces' normals to the sum of w j j^T.
  Matrix6 noise() const;

  // ---- helpers of the functions above

  /// Weight of the prior against a weight of 1 for each source point. It does not change with nu: at the
  /// upper scales residuals are misalignment and not noise, and with a weaker prior a direction that the
  /// scene hardly constrains would drift before the other directions have converged.
  double prior_share() const { return options->sigma * options->sigma / (options->nu_min * options->nu_min); }

  Vector18 prior_error() const;

  /// A residual of a point: its distance from a plane, or one of the two components of its distance from a
  /// line.
  struct Row {
    std::size_t point;
    int knot;            // nearest to the time of the point
    Vector6 j;           // derivative by [d; eta] at that time, in the frame of the prior's pose
    double residual;     // metres
    double weight;       // of the surface
    double along = 1.0;  // share of the distance in this component: for the two of a line, 1 and 0
  };

  template <typename Visit>
  void visit_rows(const Visit& visit) const {
    const Eigen::Matrix3f to_prior = prior->mean.pose.linear().transpose().cast<float>();
    const Eigen::Vector3f origin = prior->mean.pose.translation().cast<float>();
    for (std::size_t i = 0; i < source->size(); ++i) {
      if (weights[i] <= 0) continue;
      const Surface& surface = target->surfaces.at(correspondences.indices()[i]);
      const Eigen::Vector3f world(wx[i], wy[i], wz[i]), w = to_prior * (world - origin);
      const auto add = [&](const Eigen::Vector3f& direction, double residual, double along) {
        const Eigen::Vector3f normal = to_prior * direction;
        Row row{i, motion.nearest_knot(i), Vector6(), residual, weights[i], along};
        row.j << normal.cast<double>(), w.cross(normal).cast<double>();
        visit(row);
      };
      if (surface.line) {
        const Eigen::Vector3f off = surface.scale * (world - surface.centre);
        const Eigen::Vector3f across = off - surface.normal.dot(off) * surface.normal;
        const float distance = across.norm();
        const Eigen::Vector3f a =
            distance > 0 ? Eigen::Vector3f(across / distance) : surface.normal.unitOrthogonal();
        add(surface.scale * a, distance, 1.0);
        add(surface.scale * surface.normal.cross(a), 0.0, 0.0);
      } else {
        add(surface.scale * surface.normal, residuals[i], 1.0);
      }
    }
  }

  /// For points at the time of a knot: a step [d; eta] of the state moves them as the pose step
  /// basis * [d; eta] moves points at the stamp.
  Eigen::Matrix<double, 6, 18> basis_of(int knot) const;

  /// Gauss-Newton sums of the data: H = sum s w j j^T, g = sum s w r j, with j the derivative of r by
  /// [d; eta]: pose <- prior * exp(d) * exp(x), twist <- twist + eta,
  /// acceleration <- acceleration + the last six.
  void linearise(Matrix18* hessian, Vector18* gradient) const;
  /// Sum of g g^T over the patches of the scene, g the sum of w r j over the points of a patch.
  Matrix18 scatter() const;
  std::uint64_t patch_of(std::size_t i) const;
};

}  // namespace scanlock
