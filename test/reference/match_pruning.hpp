// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithms 1 and 3 of Practical optimal registration of terrestrial LiDAR scan pairs (Cai, Chin, Parra
// Bustos, Schindler) as they are printed. Corrections of the print are marked.
#pragma once

#include "geometry/rigid.hpp"
#include "translation_search.hpp"

namespace scanlock::reference {

/// E(theta, t | C, epsilon), equation 3.
inline int aligned(const Matches& matches, double theta, const Eigen::Vector3d& t, double epsilon) {
  int count = 0;
  for (const Match& match : matches)
    count += (rotation_about_z(theta) * match.p + t - match.q).norm() <= epsilon ? 1 : 0;
  return count;
}

/// The value of Q[k], equation 23, and its angle. Correction: the sum is over J_k, where the print has I_b.
inline Stabbing rotation_problem(const Matches& matches, std::size_t k, double epsilon) {
  Matches centred;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (i != k) centred.push_back({matches[i].p - matches[k].p, matches[i].q - matches[k].q});  // 22
  }
  Stabbing result = best_angle(centred, Eigen::Vector3d::Zero(), 2 * epsilon);
  ++result.depth;
  return result;
}

struct Pruned {
  Matches matches;          // C'
  std::vector<int> bounds;  // E-bar_k, of all
  int lower_bound = 0;      // E
};

/// Algorithm 3. The lower bound is evaluated over C; C' has all inliers of any optimum over C.
inline Pruned match_pruning(const Matches& matches, double epsilon) {
  Pruned result;                                               // line 1
  for (std::size_t k = 0; k < matches.size(); ++k) {           // 2
    const Stabbing q = rotation_problem(matches, k, epsilon);  // 3
    result.bounds.push_back(q.depth);
    if (q.depth < result.lower_bound) continue;  // 4, 5
    const Eigen::Vector3d t = matches[k].q - rotation_about_z(q.theta) * matches[k].p;
    // 7. Correction: the print replaces E, which could fall; the greatest so far is the lower bound. The
    // print also sets E(theta, t) equal to U(t), which may be greater.
    result.lower_bound = std::max(result.lower_bound, aligned(matches, q.theta, t, epsilon));
  }
  for (std::size_t k = 0; k < matches.size(); ++k) {  // 10
    if (result.bounds[k] >= result.lower_bound) result.matches.push_back(matches[k]);
  }
  return result;
}

/// Algorithm 1 from its second line on.
inline Consensus max_consensus(const Matches& matches, double epsilon, int most_cubes) {
  return translation_search(match_pruning(matches, epsilon).matches, epsilon, most_cubes);
}

}  // namespace scanlock::reference
