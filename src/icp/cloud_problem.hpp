// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "geometry/rigid_fit.hpp"
#include "icp/cloud_target.hpp"
#include "icp/correspondences.hpp"
#include "icp/descent.hpp"

namespace scanlock {

enum class IcpObjective { kPoint, kPlane, kSymmetric };
/// How a motion becomes the vector that Anderson acceleration combines. Euler angles (x y z, then yaw pitch
/// roll) are the baseline that the paper improves on.
enum class MotionCoordinates { kLieAlgebra, kEulerAngles };

/// Source against target for one scale nu: the energies (1), (13), (19), (20) of the paper and the symmetric
/// one, and the step that minimises their surrogates. Poses map centred source coordinates into centred
/// target coordinates.
class CloudProblem final : public DescentProblem {
 public:
  struct Setup {
    IcpObjective objective = IcpObjective::kPoint;
    MotionCoordinates coordinates = MotionCoordinates::kLieAlgebra;
    bool robust = true;
    int threads = 1;
  };
  /// Source (with normals for the symmetric objective) and target must outlive this object.
  CloudProblem(const PointCloud& source, const CloudTarget& target, const Setup& setup);

  /// Starts a level: `nu` (unused unless robust) and `gate`, beyond which pairs do not count, metres. Returns
  /// the state of `start`; coordinates of the Lie algebra are taken relative to it, far from the cut of the
  /// logarithm at pi.
  StateVector begin(const Pose& start, double nu, double gate);

  double evaluate(const StateVector& x) override;
  StateVector image() override;
  double distance(const StateVector& a, const StateVector& b) const override;

  Pose pose_of(const StateVector& x) const;
  StateVector state_of(const Pose& pose) const;

  /// At the state evaluated last: residuals (NaN without a pair), and squared distances of the pairs.
  const std::vector<float>& residuals() const { return residuals_; }
  const std::vector<float>& squared_distances() const { return squared_distances_; }
  const std::vector<float>& weights() const { return weights_; }
  const Correspondences& correspondences() const { return correspondences_; }
  const Pose& pose() const { return pose_; }

 private:
  void measure_pair(std::size_t i, std::size_t q, const Eigen::Matrix3f& rotation);
  Pose point_step() const;
  Pose plane_step() const;
  Eigen::Vector3f pair_normal(std::size_t i, std::size_t q, const Eigen::Matrix3f& rotation) const;

  const PointCloud& source_;
  const CloudTarget& target_;
  Setup setup_;
  double nu_ = 1, gate_ = 1, arm_ = 1;
  Pose base_ = Pose::Identity(), pose_ = Pose::Identity();
  Correspondences correspondences_;
  std::vector<float> x_, y_, z_;
  std::vector<float> residuals_, squared_distances_, weights_;
};

}  // namespace scanlock
