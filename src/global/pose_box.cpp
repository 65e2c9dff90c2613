// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/pose_box.hpp"

#include <algorithm>
#include <cmath>

namespace scanlock {

BoxFilter::BoxFilter(const LevelMatches& m) {
  matches_.reserve(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double bounding = bounding_limit(m, i), counting = counting_limit(m, i);
    matches_.push_back({m.px[i], m.py[i], m.qx[i], m.qy[i], m.dz[i], bounding * bounding, counting * counting,
                        std::hypot(m.px[i], m.py[i])});
  }
}

BoxCounts BoxFilter::filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                            std::vector<std::uint32_t>& kept) const {
  const double c = std::cos(box.centre.theta), s = std::sin(box.centre.theta);
  // The arc of R p reaches from its middle r along -r by up to |r| (1 - cos) and across by up to |r| sin.
  const double across = std::sin(box.half_theta), along = 0.5 * (1 - std::cos(box.half_theta)),
               middle = 1 - along;
  const double x = box.centre.x, y = box.centre.y, z = box.centre.z;
  const double half_x = box.half_x, half_y = box.half_y, half_z = box.half_z;
  kept.resize(list.size());
  std::uint32_t* out = kept.data();
  BoxCounts counts;
  double levers = 0;
  for (const std::uint32_t i : list) {
    const Packed& m = matches_[i];
    const double rx = c * m.px - s * m.py, ry = s * m.px + c * m.py;
    const double dz = std::abs(m.dz - z);
    const double ax = std::abs(rx), ay = std::abs(ry);
    const double gap_x =
        std::max(0.0, std::abs(m.qx - middle * rx - x) - (half_x + ay * across + ax * along));
    const double gap_y =
        std::max(0.0, std::abs(m.qy - middle * ry - y) - (half_y + ax * across + ay * along));
    const double gap_z = std::max(0.0, dz - half_z);
    const double ux = m.qx - rx - x, uy = m.qy - ry - y;
    *out = i;
    const bool possible = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z <= m.bounding2;
    out += possible;
    levers += possible ? m.lever : 0.0;
    counts.at_centre += ux * ux + uy * uy + dz * dz <= m.counting2;
  }
  counts.possible = static_cast<int>(out - kept.data());
  kept.resize(static_cast<std::size_t>(counts.possible));
  if (counts.possible > 0) counts.lever = levers / counts.possible;
  return counts;
}

}  // namespace scanlock
