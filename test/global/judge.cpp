// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "judge.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <queue>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

using Eigen::Vector3d;

struct Ball {
  Vector3d centre;
  double radius;
};

/// The number of balls that contain x, up to rounding.
int depth_at(const std::vector<Ball>& near, const Vector3d& x) {
  int count = 0;
  for (const Ball& ball : near) count += (x - ball.centre).norm() <= ball.radius * (1 + 1e-12) + 1e-13;
  return count;
}

/// Calls visit(x) for the lowest point of the circle in which two spheres intersect, if there is such a
/// circle.
template <typename Visit>
void circle_bottom(const Ball& a, const Ball& b, const Visit& visit) {
  const Vector3d d = b.centre - a.centre;
  const double length = d.norm();
  if (!(length > 0)) return;
  const Vector3d axis = d / length;
  const double h = (length * length + a.radius * a.radius - b.radius * b.radius) / (2 * length);
  const double square = a.radius * a.radius - h * h;
  const Vector3d down = -(Vector3d::UnitZ() - axis * axis.z());
  if (square < 0 || !(down.norm() > 1e-12)) return;
  visit(Vector3d(a.centre + h * axis + std::sqrt(square) * down.normalized()));
}

/// Calls visit(x) for the common points of three spheres.
template <typename Visit>
void corners(const Ball& a, const Ball& b, const Ball& c, const Visit& visit) {
  const Vector3d ab = b.centre - a.centre, ac = c.centre - a.centre;
  const double d = ab.norm();
  if (!(d > 0)) return;
  const Vector3d ex = ab / d;
  const double i = ex.dot(ac);
  const Vector3d rest = ac - i * ex;
  const double j = rest.norm();
  if (!(j > 1e-13)) return;
  const Vector3d ey = rest / j, ez = ex.cross(ey);
  const double x = (a.radius * a.radius - b.radius * b.radius + d * d) / (2 * d);
  const double y = (a.radius * a.radius - c.radius * c.radius + i * i + j * j) / (2 * j) - i / j * x;
  const double square = a.radius * a.radius - x * x - y * y;
  if (square < 0) return;
  const Vector3d foot = a.centre + x * ex + y * ey;
  visit(Vector3d(foot + std::sqrt(square) * ez));
  visit(Vector3d(foot - std::sqrt(square) * ez));
}

/// The largest number of balls with a common point if that is more than `known`, else `known`.
int deepest(const std::vector<Ball>& balls, int known) {
  std::vector<Ball> near;
  for (std::size_t a = 0; a < balls.size(); ++a) {
    near.clear();
    for (std::size_t b = 0; b < balls.size(); ++b) {
      const double apart = (balls[a].centre - balls[b].centre).norm();
      if (b != a && apart <= (balls[a].radius + balls[b].radius) * (1 + 1e-12)) near.push_back(balls[b]);
    }
    if (static_cast<int>(near.size()) + 1 <= known) continue;
    near.push_back(balls[a]);
    const auto visit = [&](const Vector3d& x) { known = std::max(known, depth_at(near, x)); };
    const auto more_is_possible = [&] { return known < static_cast<int>(near.size()); };
    visit(balls[a].centre - balls[a].radius * Vector3d::UnitZ());
    for (std::size_t b = 0; b + 1 < near.size() && more_is_possible(); ++b) {
      circle_bottom(balls[a], near[b], visit);
      for (std::size_t c = b + 1; c + 1 < near.size() && more_is_possible(); ++c)
        corners(balls[a], near[b], near[c], visit);
    }
  }
  return known;
}

std::vector<Ball> balls_at(const Matches& matches, double radius, double theta, double half_width) {
  const Eigen::AngleAxisd turn(theta, Vector3d::UnitZ());
  std::vector<Ball> balls;
  for (const Match& m : matches) {
    balls.push_back({m.q - turn * m.p, radius + m.p.head<2>().norm() * half_width});
  }
  return balls;
}

struct Interval {
  int bound;
  double theta, half_width;
  bool operator<(const Interval& other) const { return bound < other.bound; }
};

}  // namespace

int judged_consensus(const Matches& matches, double epsilon) {
  if (matches.empty()) return 0;
  const double narrow = epsilon * (1 + 0.5e-9), wide = epsilon * (1 + 1e-9);
  double reach = 0;
  for (const Match& m : matches) reach = std::max(reach, m.p.head<2>().norm());
  const int pieces = std::max(1, static_cast<int>(std::ceil(2 * kPi * reach / epsilon)));
  int best = 0;
  std::priority_queue<Interval> open;
  for (int i = 0; i < pieces; ++i) {
    open.push({static_cast<int>(matches.size()), kPi * (2 * i + 1) / pieces, kPi / pieces * (1 + 1e-12)});
  }
  while (!open.empty() && open.top().bound > best) {
    const Interval top = open.top();
    open.pop();
    best = deepest(balls_at(matches, wide, top.theta, 0), best);
    const int bound =
        std::min(top.bound, deepest(balls_at(matches, narrow, top.theta, top.half_width), best));
    if (bound <= best) continue;
    const double half = 0.5 * top.half_width;
    open.push({bound, top.theta - half, half * (1 + 1e-12)});
    open.push({bound, top.theta + half, half * (1 + 1e-12)});
  }
  return best;
}

int counted_consensus(const Matches& matches, double epsilon, const Eigen::Isometry3d& target_from_source) {
  int count = 0;
  for (const Match& m : matches)
    count += (target_from_source * m.p - m.q).norm() <= epsilon * (1 + 2e-9) + 1e-12;
  return count;
}

}  // namespace scanlock
