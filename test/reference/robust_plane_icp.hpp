// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithm 2 of Fast and Robust Iterative Closest Point (Zhang, Yao, Deng) as it is printed, line by line,
// in doubles and with a search through all points. Corrections of the print are marked. Elements of se(3) are
// [u; delta], as in the rest of this project; the print has [delta; u].
#pragma once

#include "geometry/linear.hpp"
#include "plane_jacobian.hpp"
#include "robust_point_icp.hpp"

namespace scanlock::reference {

/// E_nu of problem (20): the sum of equation 14 over the distances to the tangent planes, whose normals are
/// n.
inline double plane_energy(const Points& p, const Points& q, const Points& n, const Vector6& t, double nu) {
  const Pose pose = se3_exp(t);
  const std::vector<Eigen::Index> nearest = correspondence(p, q, pose);
  double sum = 0;
  for (Eigen::Index i = 0; i < p.cols(); ++i) {
    const Eigen::Index at = nearest[static_cast<std::size_t>(i)];
    const double b = n.col(at).dot(pose * p.col(i) - q.col(at));
    sum += 1 - std::exp(-b * b / (2 * nu * nu));
  }
  return sum;
}

/// G_ppl(T), equation 26: the nearest points at T, then the linear system (25).
inline Vector6 g_ppl(const Points& p, const Points& q, const Points& n, const Vector6& t, double nu) {
  const Pose pose = se3_exp(t);
  const std::vector<Eigen::Index> nearest = correspondence(p, q, pose);
  const PoseDerivatives d = appendix_d(t.tail<3>(), t.head<3>());
  Matrix6 left = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (Eigen::Index i = 0; i < p.cols(); ++i) {
    const Eigen::Index at = nearest[static_cast<std::size_t>(i)];
    const double b = n.col(at).dot(pose * p.col(i) - q.col(at)), gamma = std::exp(-b * b / (2 * nu * nu));
    Vector6 j;
    for (int c = 0; c < 3; ++c) {
      j[c] = n.col(at).dot(d.by_u.col(c));
      j[3 + c] = n.col(at).dot(d.rotation[static_cast<std::size_t>(c)] * p.col(i) + d.by_delta.col(c));
    }
    left += gamma * j * j.transpose();
    // Correction of equation 25: the print has B - J^T T. The linearisation (24) vanishes for J^T T - B.
    right += gamma * j * (j.dot(t) - b);
  }
  return solve(left, right);
}

inline Pose robust_plane_icp(const Points& p, const Points& q, const Points& n, const Pose& start,
                             const RobustIcpOptions& options) {
  std::vector<Vector6> t{se3_log(start)}, g, f;
  const auto e_nu = [&](const Vector6& x, double nu) { return plane_energy(p, q, n, x, nu); };
  int k = 1;  // line 1
  double nu = options.nu_max;
  while (true) {                // 2
    const int k_start = k - 1;  // 3
    double e_prev = std::numeric_limits<double>::infinity();
    Vector6 t_star = g_ppl(p, q, n, at(t, k - 1), nu);
    at(g, k - 1) = at(t, k) = t_star;  // 4
    at(f, k - 1) = at(g, k - 1) - at(t, k - 1);
    while (k - k_start <= options.most_iterations) {                             // 5
      double e = e_nu(at(t, k), nu);                                             // 7
      if (e >= e_prev) {                                                         // 8
        double tau = 1;                                                          // 10
        for (int l = 1; l <= options.most_line_search_steps; ++l) {              // 11
          const Vector6 t_trial = at(t, k - 1) + tau * (t_star - at(t, k - 1));  // 12
          const double e_trial = e_nu(t_trial, nu);                              // 13
          if (e_trial < e) {                                                     // 14
            e = e_trial;                                                         // 15
            at(t, k) = t_trial;
          }
          if (e_trial < e_prev) break;  // 17
          // Correction: the print changes neither tau nor l in the loop, which then does not end.
          tau /= 2;
        }
      }
      e_prev = e;                                               // 19
      t_star = g_ppl(p, q, n, at(t, k), nu);                    // 21
      if ((t_star - at(t, k)).norm() < options.epsilon) break;  // 22
      at(g, k) = t_star;                                        // 24
      at(f, k) = at(g, k) - at(t, k);
      // 25 to 27. Correction: the print takes exp() of what is an element of se(3), and stays one.
      at(t, k + 1) = accelerated(g, f, k, k_start, options.m);
      ++k;  // 28
    }
    if (k - k_start > options.most_iterations) --k;      // Correction: as in algorithm 1
    if (nu == options.nu_min) return se3_exp(at(t, k));  // 30
    nu = std::max(nu / 2, options.nu_min);               // 31
    ++k;
  }
}

}  // namespace scanlock::reference
