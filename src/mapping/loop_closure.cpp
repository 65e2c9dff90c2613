// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/loop_closure.hpp"

#include <cstdio>
#include <limits>

namespace scanlock {
namespace {

constexpr double kLeastShare = 0.8;  // of the inlier ratio in the recent map
constexpr double kStill = 1e8;   // information of a velocity of 0: archived points were seen at one instant
constexpr double kFloor = 1e-3;  // metres and radians: no pose is predicted better

PreparedScan prepared(const ClosureRequest& request) {
  PreparedScan scan;
  scan.source = scan.fine = *request.keyframe.points;
  scan.whole = scan.source.size();
  scan.voxel = request.voxel;
  scan.median_range = static_cast<double>(request.keyframe.reach);
  scan.planar = request.planar;
  return scan;
}

Attempt align(const ClosureRequest& request, const std::vector<ArchivedKeyframe>& map,
              const Matrix6& covariance, const TrackerConfig& config) {
  const Pose& expected = request.keyframe.map_from_body;
  Odometer odometer(config);
  odometer.set_planar(request.planar);
  odometer.reload(map, {expected.translation()}, request.voxel);
  odometer.set_usual(request.usual);
  MotionPrior prior;
  prior.mean.pose = expected;
  prior.information.topLeftCorner<6, 6>() =
      inverse(Matrix6(covariance + kFloor * kFloor * Matrix6::Identity()));
  prior.information.bottomRightCorner<6, 6>() = kStill * Matrix6::Identity();
  return odometer.look_far(prepared(request), prior);
}

}  // namespace

ClosureAnswer close_loop(const ClosureRequest& request, const TrackerConfig& config) {
  ClosureAnswer answer;
  answer.serial = request.serial;
  const Attempt here = align(request, request.recent, Matrix6::Zero(), config);
  const Attempt there = align(request, request.earlier, request.covariance, config);
  const Pose& found = there.alignment.moving.pose;
  const Matrix6 information = there.information();
  const Vector6 moved = se3_log(request.keyframe.map_from_body.inverse() * found);
  const double gap =
      moved.dot(inverse(Matrix6(request.covariance + kFloor * kFloor * Matrix6::Identity())) * moved);
  const bool explained = there.health.share >= kLeastShare * here.health.share;
  const double any_score = std::numeric_limits<double>::infinity();  // the recent map says what is usual
  answer.found = explains(there, any_score) && explained && gap < kOnceInThousand;

  char text[160];
  std::snprintf(text, sizeof text,
                "inlier ratio %.2f of %.2f, moved by %.3f m and %.2f deg, squared gap %.1f",
                there.health.share, here.health.share, moved.head<3>().norm(),
                57.29577951308232 * moved.tail<3>().norm(), gap);
  answer.reason = text;
  for (const ArchivedKeyframe& k : request.earlier) {
    if (k.id == request.nearest) answer.constraint.from_to = k.map_from_body.inverse() * found;
  }
  answer.constraint.from = request.nearest;
  answer.constraint.to = request.keyframe.id;
  answer.constraint.information = information;
  answer.constraint.loop_closure = true;
  return answer;
}

}  // namespace scanlock
