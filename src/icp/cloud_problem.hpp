// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/rigid_fit.hpp"
#include "icp/cloud_target.hpp"
#include "icp/correspondences.hpp"
#include "icp/robust_icp.hpp"

namespace scanlock {

enum class IcpObjective { kPoint, kPlane, kSymmetric };
/// The coordinates of a motion, of which Anderson acceleration takes linear combinations. Euler angles (x y
/// z, then yaw pitch roll) are the baseline that the paper improves on.
enum class MotionCoordinates { kLieAlgebra, kEulerAngles };

/// The alignment of a source to a target at one scale nu: the energies (1), (13), (19), (20) of the paper and
/// the symmetric energy, and the steps that minimise their surrogates. Poses map centred source coordinates
/// to centred target coordinates.
class CloudProblem final : public DescentProblem {
 public:
  struct Setup {
    IcpObjective objective = IcpObjective::kPoint;
    MotionCoordinates coordinates = MotionCoordinates::kLieAlgebra;
    bool robust = true;
    int threads = 1;
    int candidates = Correspondences::kCandidates;  ///< as in Correspondences::reset()
  };
  /// `candidates` for methods with few and long steps, those with distances to planes.
  static constexpr int kFewCandidates = 3;
  /// Source (with normals for the symmetric objective) and target must outlive this object.
  CloudProblem(const PointCloud& source, const CloudTarget& target, const Setup& setup);

  /// Starts a level with `nu` (unused unless robust) and `gate`, beyond which pairs do not count, both in
  /// metres. Returns the state of `start`; coordinates of the Lie algebra are relative to it, far from the
  /// discontinuity of the logarithm at pi.
  StateVector begin(const Pose& start, double nu, double gate);

  /// Changes the objective (the symmetric one requires normals of the source); the nearest points found so
  /// far remain valid. Call begin() afterwards.
  void use_objective(IcpObjective objective) { setup_.objective = objective; }

  double evaluate(const StateVector& x) override;
  StateVector image() override;
  double distance(const StateVector& a, const StateVector& b) const override;

  Pose pose_of(const StateVector& x) const;
  StateVector state_of(const Pose& pose) const;

  /// Uses only the first `n` points of the source from now on; stored correspondences of the other points
  /// remain.
  void use_first(std::size_t n);
  std::size_t used() const { return used_; }

  /// A source point and its nearest target point at the state evaluated last.
  struct Pair {
    std::int32_t target = -1;  ///< -1: none within the gate
    Eigen::Vector3f moved = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    float squared_distance = std::numeric_limits<float>::quiet_NaN();
    float residual = std::numeric_limits<float>::quiet_NaN();  ///< NaN: the pair does not count
    double weight = 0;
  };
  Pair pair(std::size_t i) const;
  float squared_distance(std::size_t i) const;  ///< that of pair(i) alone, m^2; NaN without a pair

  /// Medians, metres, of the distances and of the absolute residuals of about `count` points, evenly spaced
  /// in the order of those in use; points without a pair are left out.
  double median_distance(std::size_t count) const;
  double median_residual(std::size_t count) const;

  const PointCloud& source() const { return source_; }
  const Correspondences& correspondences() const { return correspondences_; }
  const Pose& pose() const { return pose_; }

 private:
  /// Sums of one pass over the source. Each chunk has its own, so that the order of additions, and with it
  /// every bit of the result, does not depend on the number of threads.
  struct Sums {
    double energy = 0;
    PairSums points;
    Matrix6 hessian = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    std::int64_t searches = 0;
  };
  struct Motion {
    Eigen::Matrix3f rotation;
    Eigen::Vector3f translation;
  };
  Eigen::Vector3f moved(std::size_t i, const Motion& by) const;
  Pair measure(std::size_t i, std::int32_t target, const Eigen::Vector3f& moved, const Motion& by) const;
  void add_plane(const Pair& pair, Sums* sums) const;
  void gather(std::size_t begin, std::size_t end, const Motion& by, Sums* sums);
  Pose point_step() const;
  Pose plane_step() const;
  Eigen::Vector3f pair_normal(std::size_t i, std::size_t q, const Eigen::Matrix3f& rotation) const;

  const PointCloud& source_;
  const CloudTarget& target_;
  Setup setup_;
  std::size_t used_ = 0;
  double nu_ = 1, gate_ = 1, arm_ = 1;
  Pose base_ = Pose::Identity(), pose_ = Pose::Identity();
  Correspondences correspondences_;
  Motion motion_{Eigen::Matrix3f::Identity(), Eigen::Vector3f::Zero()};  ///< pose_
  Sums sums_;
};

/// The pose of a pure translation.
Pose translation_by(const Eigen::Vector3d& metres);

/// A gate, metres, wide enough for all pairs of points at `pose`, which is between the centred frames.
double open_gate(const CentredCloud& source, const CloudTarget& target, const Pose& pose);

}  // namespace scanlock
