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
  int possible = 0;   ///< matches that some pose of the box may hold: bounds the consensus in the box
  int at_centre = 0;  ///< matches that its centre holds: that pose's consensus
  double lever = 0;   ///< metres: mean distance of the possible matches' p from the axis
};

/// Counts matches in boxes. Height, horizontal axes and angle are bounded apart, which is tighter than the
/// paper's ball around a cube (equation 14): while theta sweeps the box, R p runs along an arc, and q - R p
/// stays in the rectangle about that arc; its gaps to the box make a Euclidean distance that every pose of
/// the box exceeds.
class BoxFilter {
 public:
  explicit BoxFilter(const LevelMatches& matches) : m_(matches), places_(matches.size(), kNowhere) {}
  /// Replaces `kept` by the possible ones of `list`.
  BoxCounts filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                   std::vector<std::uint32_t>& kept);
  /// Shrinks the box of the last filter() to poses that `wanted` of the kept matches may hold: along each
  /// axis a match leaves an interval, and the box need not reach beyond where enough intervals overlap. False
  /// when they overlap nowhere.
  bool contract(int wanted, PoseBox& box) const;

 private:
  void set_angles(double theta, double half_theta);
  struct Packed {
    Eigen::Array2d p, q;
    double dz, bounding2, counting2, lever;
    float reach, shrink, inverse, inverse2;  // the bounding limit, half of 1 / that, 1 / lever, 1 / lever^2
  };
  const Packed& packed(std::uint32_t match);

  static constexpr std::uint32_t kNowhere = 0xffffffff;
  const LevelMatches& m_;
  std::vector<std::uint32_t> places_;  // in packed_: few matches of many ever come into a box
  std::vector<Packed> packed_;
  // Of the last box, for its sister often has the same angles.
  double theta_ = 0, half_theta_ = 0, cos_ = 1, sin_ = 0, across_ = 0, along_ = 0;
  // Of each match that was kept: an interval about the centre of the box along x, y, z and theta. Starts, and
  // ends negated.
  std::vector<Eigen::Array4f> starts_, minus_ends_;
  int possible_ = 0;
};

}  // namespace scanlock
