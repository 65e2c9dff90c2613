// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/bounds/box_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

using Values = std::vector<Eigen::Array4f>;

/// In each lane, the value that is exceeded by kDrops other values.
template <int kDrops>
Eigen::Array4f high_value(const Values& values, std::size_t n) {
  Eigen::Array4f top[kDrops + 1];
  for (Eigen::Array4f& value : top) value.setConstant(-std::numeric_limits<float>::infinity());
  for (std::size_t k = 0; k < n; ++k) {
    Eigen::Array4f value = values[k];
    for (int rank = 0; rank < kDrops; ++rank) {
      const Eigen::Array4f less = top[rank].min(value);
      top[rank] = top[rank].max(value);
      value = less;
    }
    top[kDrops] = top[kDrops].max(value);
  }
  return top[kDrops];
}

constexpr int kMostDrops = 11;

template <int... kDrops>
Eigen::Array4f high_value(const Values& values, std::size_t n, int drops,
                          std::integer_sequence<int, kDrops...>) {
  constexpr Eigen::Array4f (*kOfDrops[])(const Values&, std::size_t) = {high_value<kDrops>...};
  return kOfDrops[drops](values, n);
}

Eigen::Array4f high_value(const Values& values, std::size_t n, int drops) {
  return high_value(values, n, drops, std::make_integer_sequence<int, kMostDrops + 1>{});
}

constexpr int kBins = 16;  // of an axis

/// Narrows a side to the bins that at least `wanted` intervals overlap; false if there are none.
bool narrow(const std::array<int, kBins>& starts, const std::array<int, kBins>& ends, int wanted,
            double& centre, double& half) {
  int before = 0, last = -1, depth = 0;  // bins before the first
  for (int b = 0; b < kBins; ++b) {
    depth += starts[static_cast<std::size_t>(b)];
    const bool enough = depth >= wanted;
    last = enough ? b : last;
    before += last < 0;
    depth -= ends[static_cast<std::size_t>(b)];
  }
  if (last < 0) return false;
  if (before == 0 && last == kBins - 1) return true;
  centre += half * (before + last + 1 - kBins) / kBins;
  half *= (last + 1 - before) * (1 + 1e-12) / kBins;
  return true;
}

double LevelPose::*const kCentres[] = {&LevelPose::x, &LevelPose::y, &LevelPose::z, &LevelPose::theta};
double PoseBox::*const kHalves[] = {&PoseBox::half_x, &PoseBox::half_y, &PoseBox::half_z,
                                    &PoseBox::half_theta};

/// Contracts the box by the number of intervals that overlap each bin of a side.
bool contract_by_depth(const Values& starts, const Values& minus_ends, std::size_t n, int wanted,
                       PoseBox& box) {
  constexpr float kMargin = 0.01f;  // bins: more than rounding
  for (int axis = 0; axis < 4; ++axis) {
    const float scale = 0.5f * kBins / static_cast<float>(box.*kHalves[axis]);
    const float below = 0.5f * kBins - kMargin, above = 0.5f * kBins + kMargin;
    // Most intervals of a small box span the whole side.
    int through = 0;
    std::array<int, kBins> first{}, last{};
    for (std::size_t k = 0; k < n; ++k) {
      const float start = starts[k][axis] * scale + below, end = above - minus_ends[k][axis] * scale;
      if ((start < 1) & (end >= kBins - 1)) {
        ++through;
        continue;
      }
      ++first[static_cast<std::size_t>(std::max(0.0f, std::min(start, kBins - 1.0f)))];
      ++last[static_cast<std::size_t>(std::max(0.0f, std::min(end, kBins - 1.0f)))];
    }
    if (through >= wanted) continue;
    if (!narrow(first, last, wanted - through, box.centre.*kCentres[axis], box.*kHalves[axis])) return false;
  }
  return true;
}

/// Contracts the box by order statistics: it begins where all but `drops` intervals have started, and ends
/// where more than `drops` have ended.
bool contract_by_rank(const Values& starts, const Values& minus_ends, std::size_t n, int drops,
                      PoseBox& box) {
  constexpr double kMargin = 1e-5;  // of the side: more than rounding
  const Eigen::Array4d low = high_value(starts, n, drops).cast<double>(),
                       high = -high_value(minus_ends, n, drops).cast<double>();
  for (int axis = 0; axis < 4; ++axis) {
    double& half = box.*kHalves[axis];
    const double from = std::max(low[axis] - kMargin * half, -half),
                 to = std::min(high[axis] + kMargin * half, half);
    if (from > to) return false;
    if (from == -half && to == half) continue;
    box.centre.*kCentres[axis] += 0.5 * (from + to);
    half = 0.5 * (to - from) * (1 + 1e-12);
  }
  return true;
}

}  // namespace

const BoxFilter::Packed& BoxFilter::packed(std::uint32_t i) {
  if (places_[i] == kNowhere) {
    const double bounding = bounding_limit(m_, i), counting = counting_limit(m_, i);
    const double square = m_.px[i] * m_.px[i] + m_.py[i] * m_.py[i], lever = std::sqrt(square);
    constexpr double kUp = 1 + 1e-6, kTiny = 1e-15;  // rounding to float
    places_[i] = static_cast<std::uint32_t>(packed_.size());
    packed_.push_back({{m_.px[i], m_.py[i]},
                       {m_.qx[i], m_.qy[i]},
                       m_.dz[i],
                       bounding * bounding,
                       counting * counting,
                       lever,
                       static_cast<float>(bounding * kUp),
                       static_cast<float>(0.5 / (bounding * kUp)),
                       static_cast<float>(kUp / std::max(lever, kTiny)),
                       static_cast<float>(kUp / std::max(square, kTiny * kTiny))});
  }
  return packed_[places_[i]];
}

void BoxFilter::set_angles(double theta, double half_theta) {
  if (theta_ == theta && half_theta_ == half_theta) return;
  theta_ = theta;
  half_theta_ = half_theta;
  const auto [sine, cosine] = sincos(theta_);
  sin_ = sine;
  cos_ = cosine;
  // The arc of R p extends from its middle r along -r by up to |r| (1 - cos) and across by up to |r| sin.
  const SineCosine half = sincos(half_theta_);
  across_ = half.sine;
  along_ = 0.5 * (1 - half.cosine);
}

BoxCounts BoxFilter::filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                            std::vector<std::uint32_t>& kept) {
  set_angles(box.centre.theta, box.half_theta);
  // Computed for both horizontal axes at once, and then for all four axes.
  const Eigen::Array2d cosine(cos_, cos_), sine(-sin_, sin_), across(across_, across_), along(along_, along_),
      middle = 1 - along, centre(box.centre.x, box.centre.y), half(box.half_x, box.half_y);
  const double z = box.centre.z, half_z = box.half_z;
  const Eigen::Array2f float_half = half.cast<float>();
  const auto half_theta = static_cast<float>(box.half_theta);
  const float arc = half_theta * half_theta * half_theta / 6;  // largest difference between d and sin d
  constexpr float kUp = 1.000002f;                             // more than rounding
  kept.resize(list.size());
  if (starts_.size() < list.size()) {
    starts_.resize(list.size());
    minus_ends_.resize(list.size());
  }
  std::size_t count = 0;
  BoxCounts counts;
  double levers = 0;
  for (const std::uint32_t i : list) {
    const Packed& m = packed(i);
    const Eigen::Array2d r = cosine * m.p + sine * m.p.reverse(), e = m.q - centre;
    const Eigen::Array2d u = e - r, t = e - middle * r, a = r.abs(), sweep = a.reverse() * across + a * along;
    const Eigen::Array2d gap = (t.abs() - (half + sweep)).max(0.0), square = gap * gap, off = u * u;
    const double dz = m.dz - z, gap_z = std::max(std::abs(dz) - half_z, 0.0), square_z = gap_z * gap_z;
    const bool possible = square[0] + square[1] + square_z <= m.bounding2;
    kept[count] = i;
    // sqrt(r^2 - g^2) <= r - g^2 / (2 r)
    const Eigen::Array2f short_xy = square.cast<float>() * m.shrink, wide = sweep.cast<float>(),
                         middle_xy = t.cast<float>();
    const float short_z = static_cast<float>(square_z) * m.shrink;
    // Along the tangent of its arc, R p has a known offset at the middle of the arc, and moves by |p| sin d.
    const Eigen::Array2d tangent = u * r.reverse();
    const Eigen::Array2f slack = float_half * a.reverse().cast<float>();
    const Eigen::Array4f middles(middle_xy[0], middle_xy[1], static_cast<float>(dz),
                                 static_cast<float>(tangent[1] - tangent[0]) * m.inverse2);
    const Eigen::Array4f reaches(m.reach - short_xy[1] - short_z + wide[0],
                                 m.reach - short_xy[0] - short_z + wide[1],
                                 m.reach - short_xy[0] - short_xy[1],
                                 (m.reach - short_z) * m.inverse + (slack[0] + slack[1]) * m.inverse2 + arc);
    const Eigen::Array4f around = reaches * kUp + middles.abs() * (kUp - 1);
    starts_[count] = middles - around;
    minus_ends_[count] = -middles - around;
    count += possible;
    levers += m.lever * static_cast<double>(possible);
    counts.at_centre += off[0] + off[1] + dz * dz <= m.counting2;
  }
  counts.possible = possible_ = static_cast<int>(count);
  kept.resize(count);
  if (count > 0) counts.lever = levers / counts.possible;
  return counts;
}

bool BoxFilter::contract(int wanted, PoseBox& box) const {
  const int drops = possible_ - wanted;
  if (drops < 0) return false;
  const auto n = static_cast<std::size_t>(possible_);
  // Order statistics ignore which intervals are dropped at either end, which matters when these are many.
  constexpr int kShare = 3;
  const bool few = drops <= kMostDrops && kShare * drops <= wanted;
  return few ? contract_by_rank(starts_, minus_ends_, n, drops, box)
             : contract_by_depth(starts_, minus_ends_, n, wanted, box);
}

}  // namespace scanlock
