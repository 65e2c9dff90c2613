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

/// The energy of a scan alignment, see ScanAligner, as a problem of descent.
/// State x = [log(prior^-1 pose); (twist - prior twist) * T; acceleration * T^2 / 8], T the duration of the
/// scan: all in metres and radians. A scan without times shows no acceleration: its state ends before it.
struct ScanProblem final : DescentProblem {
  // Inputs of the alignment under way; set by begin().
  const PointCloud* source = nullptr;
  const AlignmentTarget* target = nullptr;
  const MotionPrior* prior = nullptr;
  const ScanAlignmentOptions* options = nullptr;

  ScanMotion motion;
  Correspondences correspondences;
  double nu = 1.0;
  double duration = 0.1;  // seconds: makes a velocity a displacement
  double arm = 10.0;      // metres: makes a rotation the motion of a typical point
  Vector6 x = Vector6::Zero(), twist = Vector6::Zero(), acceleration = Vector6::Zero();
  Matrix18 held = Matrix18::Zero();               // information of the prior
  std::vector<float> wx, wy, wz;                  // source in the target frame
  Eigen::Vector3f eye = Eigen::Vector3f::Zero();  // the sensor at the stamp, target frame
  // Per source point, NaN and 0 without a surface; see ScanAligner.
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
  /// Residuals at the current correspondences, and the energy.
  double measure();
  double median_absolute_residual() const;

  // ---- what the outcome is worth: scan_uncertainty.cpp

  /// Information and scatter of pose and twist: the acceleration is solved along, and what is not known of it
  /// is known less of them.
  void tell(ScanAlignment* result) const;
  /// The second derivative of Welsch's function, w (1 - r^2 / nu^2) along a residual and w across it, over w.
  double curvature() const;
  /// What errors of the surfaces' normals alone put into the sum of w j j^T, as expected.
  Matrix6 noise() const;

  // ---- parts of these

  /// Of the prior against a weight of 1 a source point. It does not change with nu: at the upper scales
  /// residuals are not noise but misalignment, and a direction that the scene hardly fixes would slide before
  /// the others have settled.
  double prior_share() const { return options->sigma * options->sigma / (options->nu_min * options->nu_min); }

  Vector18 prior_error() const;

  /// A residual of a point: of a plane its distance, of a line the two components of it.
  struct Row {
    std::size_t point;
    int knot;            // of its time
    Vector6 j;           // derivative by [d; eta] at that time, in the frame of the prior's pose
    double residual;     // metres
    double weight;       // of the surface
    double along = 1.0;  // share of the distance that this component is: of a line 1 and 0
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

  /// Of a point at the time of a knot: [d; eta] moves it as basis * [d; eta] would at the stamp.
  Eigen::Matrix<double, 6, 18> basis_of(int knot) const;

  /// Gauss-Newton sums of the data: H = sum s w j j^T, g = sum s w r j, with j the derivative of r by
  /// [d; eta]: pose <- prior * exp(d) * exp(x), twist <- twist + eta,
  /// acceleration <- acceleration + the last six.
  void linearise(Matrix18* hessian, Vector18* gradient) const;
  /// Sum of g g^T over the patches of the scene, g the sum of w r j of the points in it.
  Matrix18 scatter() const;
  std::uint64_t patch_of(std::size_t i) const;
};

}  // namespace scanlock
