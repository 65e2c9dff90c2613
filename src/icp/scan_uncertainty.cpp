// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Uncertainty of a scan alignment: the parts of the sandwich covariance of an M-estimator.
#include <algorithm>
#include <cmath>
#include <utility>

#include "icp/scan_problem.hpp"

namespace scanlock {
namespace {

/// Residuals spread evenly over the kernel have a curvature near 0: the bound keeps quotients finite.
constexpr double kLeastCurvature = 0.05;

}  // namespace

double ScanProblem::curvature() const {
  double bent = 0, straight = 0;
  visit_rows([&](const Row& row) {
    const double weight = row.weight * kernel[row.point], r = residuals[row.point] / nu;
    bent += weight * (1.0 - row.along * r * r);
    straight += weight;
  });
  return straight > 0 ? std::max(bent / straight, kLeastCurvature) : 1.0;
}

Matrix18 ScanProblem::scatter() const {
  std::vector<Eigen::Matrix<double, 6, 18>> bases;
  for (int k = 0; k <= ScanMotion::kKnots; ++k) bases.push_back(basis_of(k));
  std::vector<std::pair<std::uint64_t, Vector18>> parts;
  parts.reserve(source->size());
  visit_rows([&](const Row& row) {
    if (row.along == 0) return;  // its residual is zero
    const double force = row.weight * kernel[row.point] * row.residual;
    parts.emplace_back(patch_of(row.point),
                       force * bases[static_cast<std::size_t>(row.knot)].transpose() * row.j);
  });
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Matrix18 scatter = Matrix18::Zero();
  for (std::size_t i = 0; i < parts.size();) {
    Vector18 sum = Vector18::Zero();
    const std::uint64_t patch = parts[i].first;
    for (; i < parts.size() && parts[i].first == patch; ++i) sum += parts[i].second;
    scatter.selfadjointView<Eigen::Lower>().rankUpdate(sum);
  }
  return scatter.selfadjointView<Eigen::Lower>();
}

std::uint64_t ScanProblem::patch_of(std::size_t i) const {
  const auto cell = [&](float metres) {
    const double cells = std::floor(static_cast<double>(metres) / options->patch);
    return static_cast<std::uint64_t>(std::clamp(cells, -1e6, 1e6) + 1e6);
  };
  return cell(wx[i]) << 42 | cell(wy[i]) << 21 | cell(wz[i]);
}

Matrix6 ScanProblem::noise() const {
  Matrix6 result = Matrix6::Zero();
  const Eigen::Matrix3f to_prior = prior->mean.pose.linear().transpose().cast<float>();
  const Eigen::Vector3f origin = prior->mean.pose.translation().cast<float>();
  for (std::size_t i = 0; i < source->size(); ++i) {
    if (weights[i] <= 0) continue;
    const Surface& surface = target->surfaces.at(correspondences.indices()[i]);
    if (surface.line) continue;
    const double weight = weights[i] * kernel[i] * surface.scale * surface.scale;
    const Eigen::Vector3f w = to_prior * (Eigen::Vector3f(wx[i], wy[i], wz[i]) - origin);
    const Eigen::Vector3f across = surface.tilt_across * surface.normal.cross(surface.tilt).normalized();
    for (const Eigen::Vector3f& tilt : {surface.tilt, across}) {
      const Eigen::Vector3f error = to_prior * tilt;
      Vector6 j;
      j << error.cast<double>(), w.cross(error).cast<double>();
      result.selfadjointView<Eigen::Lower>().rankUpdate(j, weight);
    }
  }
  return result.selfadjointView<Eigen::Lower>();
}

void ScanProblem::tell(ScanAlignment* result) const {
  Matrix18 all;
  Vector18 gradient;
  linearise(&all, &gradient);
  const double variance = options->sigma * options->sigma;
  const Matrix6 expected = variance * held.bottomRightCorner<6, 6>();
  Eigen::Matrix<double, 12, 18> along = Eigen::Matrix<double, 12, 18>::Identity();
  along.rightCols<6>() =
      -all.topRightCorner<12, 6>() * inverse(Matrix6(all.bottomRightCorner<6, 6>() + expected));
  result->pose_information = all.topLeftCorner<6, 6>();
  result->information = all.topLeftCorner<12, 12>() + along.rightCols<6>() * all.bottomLeftCorner<6, 12>();
  // The scatter of the gradient of the acceleration's prior, which at the true acceleration is not zero
  // either.
  Matrix18 scattered = scatter();
  scattered.bottomRightCorner<6, 6>() += variance * expected;
  result->scatter = along * scattered * along.transpose();
}

}  // namespace scanlock
