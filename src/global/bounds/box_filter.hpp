// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "global/bounds/pose_box.hpp"
#include "global/matches.hpp"

namespace scanlock {

/// Bounds of the consensus within a box.
struct BoxCounts {
  int possible = 0;   ///< matches that some pose of the box may hold: an upper bound of the consensus
  int at_centre = 0;  ///< matches that the centre pose holds: its consensus
  double lever = 0;   ///< metres: mean distance of the possible matches' p from the axis
};

/// Counts matches in boxes. Height, horizontal axes and angle are bounded separately, which is tighter than
/// the paper's ball around a cube (equation 14): while theta sweeps the box, R p moves along an arc, and
/// q - R p stays in the bounding rectangle of that arc; the gaps between the rectangle and the box give a
/// Euclidean distance, a lower bound of the residual at every pose of the box.
class BoxFilter {
 public:
  explicit BoxFilter(const LevelMatches& matches) : m_(matches), places_(matches.size(), kNowhere) {}
  /// Sets `kept` to the possible matches of `list`.
  BoxCounts filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                   std::vector<std::uint32_t>& kept);
  /// Shrinks the box of the last filter() to poses that may hold `wanted` of the kept matches: along each
  /// axis every match allows an interval, and the box is cut to the range in which enough intervals overlap.
  /// False if enough of them overlap nowhere.
  bool contract(int wanted, PoseBox& box) const;

 private:
  void set_angles(double theta, double half_theta);
  struct Packed {
    Eigen::Array2d p, q;
    double dz, bounding2, counting2, lever;
    float reach, shrink, inverse, inverse2;  // bounding limit, 0.5 / limit, 1 / lever, 1 / lever^2
  };
  const Packed& packed(std::uint32_t match);

  static constexpr std::uint32_t kNowhere = 0xffffffff;
  const LevelMatches& m_;
  std::vector<std::uint32_t> places_;  // index in packed_, set on first use: most matches are never in a box
  std::vector<Packed> packed_;
  // Values of the last box, kept because the other half of the same parent often has the same angles.
  double theta_ = 0, half_theta_ = 0, cos_ = 1, sin_ = 0, across_ = 0, along_ = 0;
  // For each kept match: its interval along x, y, z and theta, relative to the centre of the box; starts, and
  // negated ends.
  std::vector<Eigen::Array4f> starts_, minus_ends_;
  int possible_ = 0;
};

}  // namespace scanlock
