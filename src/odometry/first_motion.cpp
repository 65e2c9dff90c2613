// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The velocity of a robot at its first two scans: Odometer::deskew_first.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "odometry/odometer.hpp"

namespace scanlock {
namespace {

// Initial speeds (m/s) along the x axis, forwards and backwards, that a vehicle may have at its first scan;
// ICP finds speeds between them.
constexpr double kSpeeds[] = {5, 10, 15, 20, 25, 30};
constexpr int kRounds = 3;
// Displacement of points from one scan to the next, in voxels: two motions that differ by less than kSame are
// the same, and a motion of less than kAtRest is rest.
constexpr double kSame = 0.2, kAtRest = 0.05;

/// Whether a displacement `by` (metres) takes a point off its surface by more than noise (metres) and the
/// error of the normal explain.
bool leaves(const PointFit& fit, const Eigen::Vector3f& by, float noise) {
  if (fit.explained <= 0) return false;
  const Surface& surface = fit.surface;
  const float along = surface.normal.dot(by);
  if (surface.line) return surface.scale * (by - along * surface.normal).norm() > noise;
  const float tilt = std::sqrt(surface.tilt.squaredNorm() + surface.tilt_across * surface.tilt_across);
  return std::abs(along) > noise + 2 * tilt * by.norm();
}

/// Number of points, weighted, by which motion `one` explains the same scan better than motion `other`. Only
/// points that the displacement between the two motions takes off their surface are counted. All other
/// points, most of them on the ground, fit at any motion, and best at rest, where the sensor measures the
/// same spots twice.
double advantage(const std::vector<PointFit>& one, const std::vector<PointFit>& other, float noise) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i) {
    const Eigen::Vector3f by = other[i].place - one[i].place;
    if (leaves(one[i], by, noise) || leaves(other[i], by, noise))
      sum += one[i].explained - other[i].explained;
  }
  return sum;
}

}  // namespace

/// A velocity deskews the first scan and predicts the second one. It is right where the alignment of the two
/// returns the same velocity; from other velocities the iteration moves towards such a fixed point. Where a
/// scene has several fixed points, zero velocity among them, the result is the one that explains most points.
Attempt Odometer::deskew_first(const PreparedScan& scan, double dt, Attempt attempt, bool any_speed) {
  if (!awaits_second()) return attempt;
  PreparedScan first;
  first.fine = std::move(first_.points);
  first.voxel = scan.voxel;
  first_.points = {};
  const Pose pose = last_keyframe_pose_;
  const auto [earliest, latest] = std::minmax_element(first.fine.time.begin(), first.fine.time.end());
  const double sweep = static_cast<double>(*latest) - *earliest;
  // A wrong velocity distorts both scans alike, so that they still fit each other. The displacement between
  // the stamps is then the better measure of the velocity, if the second scan begins about when the first
  // ends.
  const bool gapless = sweep > 0.5 * dt && dt > 0.5 * sweep;
  const auto moving_at = [&](const Vector6& twist) -> MovingPose {
    return {renormalised(pose * se3_exp(dt * twist)), twist};
  };
  const auto found_by = [&](const Attempt& a) -> MovingPose {
    return gapless ? moving_at(se3_log(pose.inverse() * a.alignment.moving.pose) / dt) : a.alignment.moving;
  };
  const auto align_held = [&](const MovingPose& second, const PreparedScan& points, MotionPrior prior) {
    map_.clear();
    insert(first_.utime, first, {pose, second.twist});
    prior.mean = second;
    return align(points, prior, Reach::kNear);
  };
  const MotionPrior loose = loosened(attempt.prior);
  const auto align_from = [&](const MovingPose& second, const PreparedScan& points) {
    return align_held(second, points, loose);
  };
  const auto same = [&](const Vector6& a, const Vector6& b, double voxels = kSame) {
    const Vector6 apart = dt * (a - b);
    return apart.head<3>().norm() + scan.median_range * apart.tail<3>().norm() < voxels * scan.voxel;
  };
  const PreparedScan part = part_of(scan, kDeskewPoints);  // enough for the first rounds
  PreparedScan all = scan;
  all.source = scan.fine;
  MovingPose best = found_by(attempt);
  std::vector<PointFit> best_fits;
  const auto note = [&](const MovingPose& second) {
    std::vector<PointFit> fits = aligner_.fits(map_.target());
    if (!best_fits.empty() && !(advantage(fits, best_fits, static_cast<float>(2 * kKernel * sigma_)) > 0))
      return;
    best = second;
    best_fits = std::move(fits);
  };
  std::vector<Vector6> tried;
  // Iterates from a velocity to a fixed point; false if it arrives at a velocity that was tried before.
  const auto settle = [&](MovingPose second) {
    for (int round = 0; round < kRounds; ++round) second = found_by(align_from(second, part));
    for (int round = 0; round < kRounds; ++round) {
      const Vector6 twist = second.twist;
      if (std::any_of(tried.begin(), tried.end(), [&](const Vector6& t) { return same(t, twist); }))
        return false;
      tried.push_back(twist);
      const Attempt aligned = align_from(second, all);
      second = found_by(aligned);
      if (!same(second.twist, twist)) continue;
      note(second);
      return true;
    }
    return true;
  };
  const MovingPose rest{pose, Vector6::Zero()};
  const Attempt rested = align_from(rest, all);
  if (same(found_by(rested).twist, rest.twist, kAtRest)) {
    tried.push_back(rest.twist);
    note(rest);
  }
  settle(found_by(attempt));
  settle(rest);
  if (gapless && any_speed) {
    // Two speeds in a row that lead, forwards and backwards, to velocities tried before end the search.
    int known = 0;
    for (const double speed : kSpeeds) {
      const bool ahead = settle(moving_at(speed * Vector6::Unit(0)));
      const bool behind = settle(moving_at(-speed * Vector6::Unit(0)));
      known = ahead || behind ? 0 : known + 1;
      if (known == 2) break;
    }
  }
  const bool at_rest = best.twist.isZero();
  for (int round = 0; round < kRounds && !at_rest; ++round) best = found_by(align_from(best, all));
  // The prior holds the velocity within the scan to the one between the scans: on a bridge, whose surfaces
  // hardly constrain a motion along it, the scan would fit with any velocity.
  Attempt result = align_held(best, scan, attempt.prior);
  result.prior = attempt.prior;
  return result;
}

}  // namespace scanlock
