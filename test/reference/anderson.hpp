// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock::reference {

/// Equation 7, as algorithm 1 prints it in lines 18 to 22 and algorithm 2 in lines 25 to 27: the element of
/// se(3) that follows from G^(0..k) and F^(0..k).
inline Vector6 accelerated(const std::vector<Vector6>& g, const std::vector<Vector6>& f, int k, int k_start,
                           int m) {
  const int m_k = std::min(k - k_start, m);
  if (m_k == 0) return g[static_cast<std::size_t>(k)];  // an empty sum
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  Eigen::MatrixXd g_steps(6, m_k), f_steps(6, m_k);
  for (int j = 1; j <= m_k; ++j) {
    g_steps.col(j - 1) = g[at(k - j + 1)] - g[at(k - j)];
    f_steps.col(j - 1) = f[at(k - j + 1)] - f[at(k - j)];
  }
  const Eigen::VectorXd theta = f_steps.colPivHouseholderQr().solve(f[at(k)]);
  return g[at(k)] - g_steps * theta;
}

/// Element k of a list, which grows where it is shorter.
template <typename Value>
Value& at(std::vector<Value>& list, int k) {
  if (list.size() <= static_cast<std::size_t>(k)) list.resize(static_cast<std::size_t>(k) + 1);
  return list[static_cast<std::size_t>(k)];
}

}  // namespace scanlock::reference
