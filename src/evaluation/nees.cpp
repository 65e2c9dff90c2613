// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/nees.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace scanlock {
namespace {

constexpr std::uint32_t kPlanarAxes = 1u << 2 | 1u << 3 | 1u << 4;  // z, roll, pitch

/// A pair and the state published with its estimate.
struct Judged {
  const PosePair* pair;
  const StampedState* said;
};

std::vector<Judged> within_first_epoch(const PosePairs& pairs, const std::vector<StampedState>& states,
                                       double before_s) {
  std::vector<Judged> judged;
  for (const PosePair& pair : pairs) {
    const StampedState* const said = said_at(states, pair.time_s);
    if (said == nullptr) continue;
    if (!judged.empty() && (pair.time_s >= before_s || said->epoch != judged.front().said->epoch)) break;
    judged.push_back({&pair, said});
  }
  return judged;
}

bool has_covariance(const StampedState& said) {
  const bool stands_for_it = said.state == TrackingState::kTracking || said.state == TrackingState::kDegraded;
  return stands_for_it && !said.covariance.isZero(0);
}

/// The first pose with a covariance after each multiple of the spacing.
std::vector<Judged> spaced(const std::vector<Judged>& judged) {
  const double begin = judged.front().pair->way_m, way = judged.back().pair->way_m - begin;
  const double spacing = way > kLongWay ? kLongNeesSpacing : kNeesSpacing;
  std::vector<Judged> taken;
  double next = spacing;
  for (const Judged& one : judged) {
    const double here = one.pair->way_m - begin;
    if (here < next || !has_covariance(*one.said)) continue;
    taken.push_back(one);
    next = spacing * (std::floor(here / spacing) + 1);
  }
  return taken;
}

/// e^T C^-1 e, with C scaled to a unit diagonal, because metres and radians differ by orders of magnitude.
double squared_by(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& error) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0)) return kInfinite;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (factor.info() != Eigen::Success) return kInfinite;
  const Eigen::VectorXd scaled = scale.cwiseProduct(error);
  return factor.matrixL().solve(scaled).squaredNorm();
}

/// x, y and yaw of a vector, or of the rows and columns of a matrix.
Eigen::VectorXd planar(const Vector6& v) {
  return Eigen::Vector3d(v[0], v[1], v[5]);
}
Eigen::MatrixXd planar(const Matrix6& m) {
  constexpr int kAxes[] = {0, 1, 5};
  Eigen::MatrixXd part(3, 3);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) part(row, column) = m(kAxes[row], kAxes[column]);
  return part;
}

Vector6 error_since(const Judged& first, const Judged& now) {
  const Pose reference = first.pair->reference.inverse() * now.pair->reference;
  const Pose estimate = first.said->map_from_body.inverse() * now.said->map_from_body;
  return se3_log(reference.inverse() * estimate);
}

}  // namespace

std::optional<Nees> normalised_error(const PosePairs& pairs, const std::vector<StampedState>& states,
                                     double before_s) {
  const std::vector<Judged> judged = within_first_epoch(pairs, states, before_s);
  if (judged.empty()) return std::nullopt;
  const std::vector<Judged> taken = spaced(judged);
  if (taken.empty()) return std::nullopt;
  const bool in_plane = std::all_of(taken.begin(), taken.end(), [](const Judged& one) {
    return (one.said->degenerate_axes & kPlanarAxes) == kPlanarAxes;
  });
  const double bound = in_plane ? kBeyond99Of3 : kBeyond99Of6;
  Nees nees;
  nees.poses = taken.size();
  nees.dof = in_plane ? 3 : 6;
  for (const Judged& one : taken) {
    const Vector6 error = error_since(judged.front(), one);
    const Matrix6& covariance = one.said->covariance;
    const double value = in_plane ? squared_by(planar(covariance), planar(error))
                                  : squared_by(Eigen::MatrixXd(covariance), Eigen::VectorXd(error));
    nees.mean += value / static_cast<double>(taken.size());
    nees.beyond_99 += value > bound ? 1 / static_cast<double>(taken.size()) : 0;
  }
  return nees;
}

}  // namespace scanlock
