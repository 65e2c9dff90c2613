// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

/// One moving average over 2 half + 1 points; beyond each end the curve is continued by its point reflection
/// there.
std::vector<Eigen::Vector2d> moving_average(const std::vector<Eigen::Vector2d>& in, int half) {
  const int n = static_cast<int>(in.size());
  half = std::min(half, n - 1);
  const auto extended = [&](int i) -> Eigen::Vector2d {
    if (i < 0) return 2 * in.front() - in[-i];
    if (i >= n) return 2 * in.back() - in[2 * (n - 1) - i];
    return in[i];
  };
  std::vector<Eigen::Vector2d> out(in.size());
  for (int i = 0; i < n; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = -half; k <= half; ++k) sum += extended(i + k);
    out[i] = sum / (2 * half + 1);
  }
  return out;
}

}  // namespace

Polyline::Polyline(const std::vector<Eigen::Vector2d>& points) {
  for (const Eigen::Vector2d& point : points)
    if (points_.empty() || (point - points_.back()).norm() > 1e-3) points_.push_back(point);
  if (points_.size() < 2) throw std::invalid_argument("a polyline needs two different points");
  const std::size_t n = points_.size();
  arc_.resize(n, 0);
  heading_.resize(n, 0);
  for (std::size_t i = 1; i < n; ++i) arc_[i] = arc_[i - 1] + (points_[i] - points_[i - 1]).norm();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d along = points_[std::min(i + 1, n - 1)] - points_[i > 0 ? i - 1 : 0];
    heading_[i] = atan2(along.y(), along.x());
    if (i > 0) heading_[i] = heading_[i - 1] + std::remainder(heading_[i] - heading_[i - 1], 2 * kPi);
  }
}

std::size_t Polyline::segment(double s) const {
  const auto after = std::upper_bound(arc_.begin(), arc_.end(), s);
  const auto index = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - arc_.begin()));
  return std::min(index, arc_.size() - 1) - 1;
}

Eigen::Vector2d Polyline::at(double s) const {
  const std::size_t i = segment(s);
  const double fraction = std::clamp((s - arc_[i]) / (arc_[i + 1] - arc_[i]), 0.0, 1.0);
  return points_[i] + fraction * (points_[i + 1] - points_[i]);
}

double Polyline::heading(double s) const {
  const std::size_t i = segment(s);
  const double fraction = std::clamp((s - arc_[i]) / (arc_[i + 1] - arc_[i]), 0.0, 1.0);
  return heading_[i] + fraction * (heading_[i + 1] - heading_[i]);
}

double Polyline::curvature(double s) const {
  const std::size_t i = segment(s);
  return (heading_[i + 1] - heading_[i]) / (arc_[i + 1] - arc_[i]);
}

Polyline Polyline::resampled(double spacing) const {
  const int count = std::max(2, static_cast<int>(std::ceil(length() / spacing)) + 1);
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) points.push_back(at(length() * i / (count - 1)));
  return Polyline(points);
}

Polyline Polyline::smoothed(double spacing, double width) const {
  std::vector<Eigen::Vector2d> points = resampled(spacing).points();
  const int half = std::max(1, static_cast<int>(std::lround(width / spacing / 2)));
  for (int pass = 0; pass < 3; ++pass) points = moving_average(points, half);
  return Polyline(points).resampled(spacing);
}

Polyline Polyline::reversed() const {
  return Polyline(std::vector<Eigen::Vector2d>(points_.rbegin(), points_.rend()));
}

Polyline Polyline::offset(double left) const {
  std::vector<Eigen::Vector2d> points = points_;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] += left * Eigen::Vector2d(-sin(heading_[i]), cos(heading_[i]));
  return Polyline(points);
}

}  // namespace scanlock
