// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithm 2 of Practical optimal registration of terrestrial LiDAR scan pairs (Cai, Chin, Parra Bustos,
// Schindler) as it is printed. Corrections of the print are marked.
#pragma once

#include <queue>
#include <stdexcept>

#include "max_stabbing.hpp"

namespace scanlock::reference {

struct Cube {
  int bound;  // U-bar, equation 14
  Eigen::Vector3d centre;
  double half_side;
  bool operator<(const Cube& other) const { return bound < other.bound; }
};

/// The result of a search: the largest consensus, its translation and angle.
struct Consensus {
  int count = 0;
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  double theta = 0;
};

/// A cube that contains every translation with an inlier (line 1 of algorithm 2 requires one): |t - q_i| is
/// at most |p_i| + epsilon.
inline Cube initial_cube(const Matches& matches, double epsilon) {
  Eigen::Array3d low = Eigen::Array3d::Constant(1e9), high = -low;
  for (const Match& match : matches) {
    const double reach = match.p.norm() + epsilon;
    low = low.min(match.q.array() - reach);
    high = high.max(match.q.array() + reach);
  }
  return {0, 0.5 * (low + high), 0.5 * (high - low).maxCoeff()};
}

/// Throws std::runtime_error after `most_cubes`: where bounds of matches coincide up to rounding the printed
/// algorithm may not end.
inline Consensus translation_search(const Matches& matches, double epsilon, int most_cubes) {
  if (matches.empty()) return {};
  const auto bounded = [&](Cube cube) {  // lemma 1: d_S is half of the diagonal
    cube.bound = best_angle(matches, cube.centre, epsilon + std::sqrt(3.0) * cube.half_side).depth;
    return cube;
  };
  std::priority_queue<Cube> w;                      // line 1
  Consensus best;                                   // U(t^)
  w.push(bounded(initial_cube(matches, epsilon)));  // 2
  for (int popped = 0; !w.empty(); ++popped) {      // 3
    if (popped > most_cubes) throw std::runtime_error("too many cubes");
    const Cube s = w.top();  // 4
    w.pop();
    if (s.bound <= best.count) break;  // 6: "prune w", which is sorted by its bounds
    // Correction: the print breaks in line 5 before line 6 takes t_S, and then returns a lesser t^.
    const Stabbing at_centre = best_angle(matches, s.centre, epsilon);                      // 5
    if (at_centre.depth > best.count) best = {at_centre.depth, s.centre, at_centre.theta};  // 6
    if (at_centre.depth == s.bound) break;                                                  // 5
    for (int o = 0; o < 8; ++o) {                                                           // 7
      const Eigen::Vector3d corner(o & 1 ? 0.5 : -0.5, o & 2 ? 0.5 : -0.5, o & 4 ? 0.5 : -0.5);
      const Cube part = bounded({0, s.centre + s.half_side * corner, 0.5 * s.half_side});
      if (part.bound > best.count) w.push(part);  // 8
    }
  }
  return best;  // 10. Correction: t^, where the print has t
}

}  // namespace scanlock::reference
