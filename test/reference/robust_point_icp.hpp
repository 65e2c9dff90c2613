// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithm 1 of Fast and Robust Iterative Closest Point (Zhang, Yao, Deng) as it is printed, line by line,
// in doubles and with a search through all points. Corrections of the print are marked.
#pragma once

#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <vector>

#include "anderson.hpp"

namespace scanlock::reference {

using Points = Eigen::Matrix3Xd;

struct RobustIcpOptions {
  double nu_max = 1, nu_min = 0.1;
  int m = 5, most_iterations = 1000;  // I_nu
  double epsilon = 1e-5;              // epsilon_nu
  int most_line_search_steps = 20;    // l_max of algorithm 2
};

/// Equation 3: the index in q of the point nearest to each T p_i.
inline std::vector<Eigen::Index> correspondence(const Points& p, const Points& q, const Pose& t) {
  std::vector<Eigen::Index> nearest(static_cast<std::size_t>(p.cols()));
  for (Eigen::Index i = 0; i < p.cols(); ++i)
    (q.colwise() - t * p.col(i)).colwise().squaredNorm().minCoeff(&nearest[static_cast<std::size_t>(i)]);
  return nearest;
}

/// The points of q with these indices.
inline Points selected(const Points& q, const std::vector<Eigen::Index>& indices) {
  Points result(3, static_cast<Eigen::Index>(indices.size()));
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = q.col(indices[static_cast<std::size_t>(i)]);
  return result;
}

/// E_nu(Q^, T): the sum of equation 14 over the distances.
inline double energy(const Points& p, const Points& q_hat, const Pose& t, double nu) {
  double sum = 0;
  for (Eigen::Index i = 0; i < p.cols(); ++i)
    sum += 1 - std::exp(-(t * p.col(i) - q_hat.col(i)).squaredNorm() / (2 * nu * nu));
  return sum;
}

/// alignment(Q^, T, nu): equation 17 in closed form, by the singular value decomposition.
inline Pose alignment(const Points& p, const Points& q_hat, const Pose& t, double nu) {
  Eigen::VectorXd omega(p.cols());
  for (Eigen::Index i = 0; i < p.cols(); ++i)
    omega[i] = std::exp(-(t * p.col(i) - q_hat.col(i)).squaredNorm() / (2 * nu * nu));
  const Eigen::Vector3d p_mean = p * omega / omega.sum(), q_mean = q_hat * omega / omega.sum();
  const Eigen::Matrix3d cross =
      (q_hat.colwise() - q_mean) * omega.asDiagonal() * (p.colwise() - p_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double det = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  Pose result = Pose::Identity();
  result.linear() =
      svd.matrixU() * Eigen::Vector3d(1, 1, det < 0 ? -1 : 1).asDiagonal() * svd.matrixV().transpose();
  result.translation() = q_mean - result.linear() * p_mean;
  return result;
}

inline Pose robust_point_icp(const Points& p, const Points& q, const Pose& start,
                             const RobustIcpOptions& options) {
  std::vector<Pose> t{start};
  std::vector<Points> q_hat;
  std::vector<Vector6> g, f;
  const auto closest = [&](const Pose& pose) { return selected(q, correspondence(p, q, pose)); };
  int k = 1;  // line 1
  double nu = options.nu_max;
  at(q_hat, 0) = closest(t[0]);
  while (true) {                // 2
    const int k_start = k - 1;  // 3
    double e_prev = std::numeric_limits<double>::infinity();
    Pose t_prime = alignment(p, at(q_hat, k - 1), at(t, k - 1), nu);  // 4
    at(t, k) = t_prime;                                               // 5
    at(q_hat, k) = closest(at(t, k));
    at(g, k - 1) = se3_log(t_prime);  // 6
    at(f, k - 1) = at(g, k - 1) - se3_log(at(t, k - 1));
    while (k - k_start <= options.most_iterations) {          // 7
      if (energy(p, at(q_hat, k), at(t, k), nu) >= e_prev) {  // 9
        at(t, k) = t_prime;                                   // 10
        at(q_hat, k) = closest(at(t, k));
      }
      e_prev = energy(p, at(q_hat, k), at(t, k), nu);      // 12
      t_prime = alignment(p, at(q_hat, k), at(t, k), nu);  // 14
      // 15. Correction: the print compares T', without an index, with T; T^(k) is meant.
      if ((at(t, k).matrix() - t_prime.matrix()).norm() < options.epsilon) break;
      at(g, k) = se3_log(t_prime);  // 17
      at(f, k) = at(g, k) - se3_log(at(t, k));
      at(t, k + 1) = se3_exp(accelerated(g, f, k, k_start, options.m));  // 18 to 22
      at(q_hat, k + 1) = closest(at(t, k + 1));                          // 23
      ++k;                                                               // 24
    }
    // Correction: after the last iteration of line 7 the print goes on with a T^(k) whose energy was not
    // compared; here the T before it is used, the last that was.
    if (k - k_start > options.most_iterations) --k;
    if (nu == options.nu_min) return at(t, k);  // 26
    nu = std::max(nu / 2, options.nu_min);      // 27
    ++k;
  }
}

}  // namespace scanlock::reference
