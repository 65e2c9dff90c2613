// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/consistency_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr int kStrikesOut = 5, kMostStrikes = 10;
// Largest differences in the motion between two scans; wheels that slip a little still predict well.
constexpr double kMotionFloor = 0.10, kMotionShare = 0.25;       // metres, plus a share of the distance
constexpr double kTurnFloor = 2.0 * kDegree, kTurnShare = 0.15;  // radians, plus a share of the turn
constexpr double kMostTilt = 4.0 * kDegree;
constexpr double kUpGain =
    0.02;  // per scan; the odometry drifts more slowly, and tilts of the ground average out

bool sure(const TrackedScan& tracked) {
  return tracked.verdict == ScanVerdict::kTracked && tracked.method == PoseMethod::kIcp &&
         tracked.state == TrackingState::kTracking;
}

std::string printed(const char* format, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

}  // namespace

bool ConsistencyCheck::Trust::count(bool contradicts) {
  contradictions += contradicts ? 1 : 0;
  strikes = std::clamp(strikes + (contradicts ? 1 : -1), 0, kMostStrikes);
  const bool before = trusted;
  trusted = trusted ? strikes < kStrikesOut : strikes == 0;
  return trusted != before;
}

std::optional<Pose> ConsistencyCheck::sensor_motion(const PriorSample& sample) const {
  if (!any_ || !sample.odometry || !last_sample_.odometry) return std::nullopt;
  const Pose body_motion = last_sample_.odometry->inverse() * *sample.odometry;
  return body_from_sensor_.inverse() * body_motion * body_from_sensor_;
}

ScanPrior ConsistencyCheck::prior(const PriorSample& sample) const {
  ScanPrior prior;
  if (motion_.trusted) prior.motion = sensor_motion(sample);
  if (level_.trusted && sample.level_from_body)
    prior.level_from_body = *sample.level_from_body * Eigen::Quaterniond(body_from_sensor_.linear());
  return prior;
}

std::optional<std::string> ConsistencyCheck::learn(const PriorSample& sample, const TrackedScan& tracked) {
  if (tracked.verdict == ScanVerdict::kDuplicateTime || tracked.verdict == ScanVerdict::kBackwardTime)
    return std::nullopt;  // the tracker did not use the scan either
  std::optional<std::string> motion = learn_motion(sample, tracked), level = learn_level(sample, tracked);
  any_ = true;
  last_sample_ = sample;
  last_tracked_ = tracked;
  if (motion && level) return *motion + "; " + *level;
  return motion ? motion : level;
}

std::optional<std::string> ConsistencyCheck::learn_motion(const PriorSample& sample,
                                                          const TrackedScan& tracked) {
  const std::optional<Pose> said = sensor_motion(sample);
  if (!said || !sure(tracked) || !sure(last_tracked_) || tracked.epoch != last_tracked_.epoch)
    return std::nullopt;
  const Pose seen = last_tracked_.map_from_body.inverse() * tracked.map_from_body;
  const double way = (said->translation() - seen.translation()).norm();
  const double turn = so3_log(said->linear().transpose() * seen.linear()).norm();
  const bool contradicts = !(way <= kMotionFloor + kMotionShare * seen.translation().norm() &&
                             turn <= kTurnFloor + kTurnShare * so3_log(seen.linear()).norm());
  if (!motion_.count(contradicts)) return std::nullopt;
  if (motion_.trusted) return "the odometry prior agrees with the scans again and is used";
  return "the odometry prior contradicts the scans, by " +
         printed("%.2f m and %.1f deg from the last scan to this one", way, turn / kDegree) +
         ", and is ignored until it agrees; check its axes, its frame and its units";
}

std::optional<std::string> ConsistencyCheck::learn_level(const PriorSample& sample,
                                                         const TrackedScan& tracked) {
  if (any_ && tracked.epoch != last_tracked_.epoch) up_.reset();  // of another map frame
  if (!sample.level_from_body || !sure(tracked)) return std::nullopt;
  const Eigen::Quaterniond level_from_sensor =
      *sample.level_from_body * Eigen::Quaterniond(body_from_sensor_.linear());
  const Eigen::Vector3d up =
      tracked.map_from_body.linear() * (level_from_sensor.conjugate() * Eigen::Vector3d::UnitZ());
  if (!up_) up_ = up;
  const double tilt = atan2(up_->cross(up).norm(), up_->dot(up));
  up_ = (*up_ + kUpGain * (up - *up_)).normalized();
  if (!level_.count(!(tilt <= kMostTilt))) return std::nullopt;
  if (level_.trusted) return "the attitude prior agrees with the scans again and is used";
  return "the attitude prior contradicts the scans: " +
         printed("its vertical is %.1f deg from the mean so far (limit %.0f deg)", tilt / kDegree,
                 kMostTilt / kDegree) +
         "; it is ignored until it agrees; check its axes";
}

}  // namespace scanlock
