// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/matches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

/// Squared residual over squared threshold.
double squared_ratio(const LevelMatches& m, std::size_t i, double c, double s, const LevelPose& pose) {
  const double dx = c * m.px[i] - s * m.py[i] + pose.x - m.qx[i];
  const double dy = s * m.px[i] + c * m.py[i] + pose.y - m.qy[i];
  const double dz = pose.z - m.dz[i];
  const double limit = counting_limit(m, i);
  return (dx * dx + dy * dy + dz * dz) / (limit * limit);
}

template <typename Visit>
void for_each_inlier(const LevelMatches& m, const LevelPose& pose, const Visit& visit) {
  const auto [s, c] = sincos(pose.theta);
  const double reach = m.largest_threshold * (1 + 2 * kRelativeTolerance) + 2 * m.rounding;
  const auto [first, last] = height_range(m, pose.z - reach, pose.z + reach);
  for (std::size_t i = first; i < last; ++i) {
    if (squared_ratio(m, i, c, s, pose) <= 1) visit(static_cast<std::uint32_t>(i));
  }
}

/// Indices by ascending height, then index. Heights are spread over many values: they are distributed to
/// bins, and then sorted within each bin.
std::vector<std::uint32_t> height_order(const std::vector<double>& heights) {
  std::vector<std::uint32_t> order(heights.size());
  if (heights.empty()) return order;
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double bins = static_cast<double>(heights.size() - 1),
               scale = *high > *low ? std::min(bins / (*high - *low), 1e300) : 0;
  const auto bin = [&, low = *low](double height) {
    return static_cast<std::size_t>(std::min((height - low) * scale, bins));
  };
  std::vector<std::uint32_t> ends(heights.size() + 1);
  for (const double height : heights) ++ends[bin(height) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  for (std::uint32_t i = 0; i < heights.size(); ++i) order[ends[bin(heights[i])]++] = i;
  std::size_t from = 0;
  for (std::size_t b = 0; b + 1 < ends.size(); from = ends[b++]) {
    if (ends[b] - from < 2) continue;
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(from), order.begin() + ends[b],
              [&](std::uint32_t a, std::uint32_t c) {
                return heights[a] != heights[c] ? heights[a] < heights[c] : a < c;
              });
  }
  return order;
}

bool raise(const LevelMatches& m, const LevelPose& pose, Incumbent& best) {
  const int count = consensus(m, pose);
  if (count <= best.consensus) return false;
  best = {pose, count};
  return true;
}

}  // namespace

void LevelMatches::reserve(std::size_t n) {
  for (std::vector<double>* column : {&px, &py, &qx, &qy, &dz, &threshold}) column->reserve(n);
  original.reserve(n);
}

void LevelMatches::push_back_from(const LevelMatches& other, std::size_t i) {
  px.push_back(other.px[i]);
  py.push_back(other.py[i]);
  qx.push_back(other.qx[i]);
  qy.push_back(other.qy[i]);
  dz.push_back(other.dz[i]);
  threshold.push_back(other.threshold[i]);
  original.push_back(other.original[i]);
  largest_threshold = std::max(largest_threshold, other.threshold[i]);
}

LevelMatches sorted_by_height(const LevelMatches& matches) {
  double reach = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    reach = std::max(reach, std::sqrt(matches.px[i] * matches.px[i] + matches.py[i] * matches.py[i]) +
                                std::sqrt(matches.qx[i] * matches.qx[i] + matches.qy[i] * matches.qy[i]) +
                                std::abs(matches.dz[i]) + matches.threshold[i]);
  }
  LevelMatches result;
  result.reserve(matches.size());
  for (const std::uint32_t i : height_order(matches.dz)) result.push_back_from(matches, i);
  constexpr double kUlps = 16 * 2.3e-16;
  result.rounding = kUlps * reach;
  return result;
}

LevelMatches select(const LevelMatches& matches, const std::vector<std::uint32_t>& subset) {
  LevelMatches result;
  result.reserve(subset.size());
  result.rounding = matches.rounding;
  for (const std::uint32_t i : subset) result.push_back_from(matches, i);
  return result;
}

std::pair<std::size_t, std::size_t> height_range(const LevelMatches& matches, double low, double high) {
  const auto first = std::lower_bound(matches.dz.begin(), matches.dz.end(), low);
  const auto last = std::upper_bound(first, matches.dz.end(), high);
  return {static_cast<std::size_t>(first - matches.dz.begin()),
          static_cast<std::size_t>(last - matches.dz.begin())};
}

std::vector<std::uint32_t> inliers(const LevelMatches& matches, const LevelPose& pose) {
  std::vector<std::uint32_t> result;
  for_each_inlier(matches, pose, [&](std::uint32_t i) { result.push_back(i); });
  return result;
}

int consensus(const LevelMatches& matches, const LevelPose& pose) {
  int count = 0;
  for_each_inlier(matches, pose, [&](std::uint32_t) { ++count; });
  return count;
}

LevelPose fit(const LevelMatches& m, const std::vector<std::uint32_t>& subset) {
  return fit(m, subset.data(), std::vector<double>(subset.size(), 1.0).data(), subset.size());
}

LevelPose fit(const LevelMatches& m, const std::uint32_t* subset, const double* weights, std::size_t size) {
  double sum = 0, px = 0, py = 0, qx = 0, qy = 0, dz = 0;
  for (std::size_t j = 0; j < size; ++j) {
    const std::uint32_t i = subset[j];
    const double w = weights[j];
    sum += w;
    px += w * m.px[i];
    py += w * m.py[i];
    qx += w * m.qx[i];
    qy += w * m.qy[i];
    dz += w * m.dz[i];
  }
  px /= sum;
  py /= sum;
  qx /= sum;
  qy /= sum;
  double dot = 0, cross = 0;
  for (std::size_t j = 0; j < size; ++j) {
    const std::uint32_t i = subset[j];
    const double ax = m.px[i] - px, ay = m.py[i] - py, bx = m.qx[i] - qx, by = m.qy[i] - qy;
    dot += weights[j] * (ax * bx + ay * by);
    cross += weights[j] * (ax * by - ay * bx);
  }
  LevelPose pose;
  pose.theta = atan2(cross, dot);
  const auto [s, c] = sincos(pose.theta);
  pose.x = qx - (c * px - s * py);
  pose.y = qy - (s * px + c * py);
  pose.z = dz / sum;
  return pose;
}

void climb(const LevelMatches& m, std::vector<std::uint32_t> subset, Incumbent& best) {
  constexpr int kIterations = 8;
  for (int i = 0; i < kIterations && !subset.empty(); ++i) {
    const LevelPose pose = fit(m, subset);
    if (!raise(m, pose, best) && i > 0) return;
    subset = inliers(m, pose);
  }
}

}  // namespace scanlock
