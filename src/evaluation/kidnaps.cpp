// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/kidnaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kJumpMetres = 1.0, kJumpAngle = 20 * kDegree;
constexpr double kAcceleration = 20, kAngularAcceleration = 50;  // m/s^2, rad/s^2: more than any vehicle's
constexpr double kRise = 1.0;                                    // metres; a larger step is a jump, not drift

double metres(const Pose& difference) {
  return difference.translation().norm();
}
double degrees(const Pose& difference) {
  return so3_log(difference.linear()).norm() / kDegree;
}

/// The rotation nearest to the mean of R_reference R_estimate^T, and the translation that goes with it.
/// Unlike a fit of the positions alone, it is well determined on a straight path, too. Uses only poses in
/// state TRACKING (and the first pose): poses that drift along a degenerate axis, as in a tunnel, are
/// DEGRADED and would bias it.
Pose mean_alignment(const PosePairs& pairs, const std::vector<StampedState>& states, double before_s,
                    Overlay kind) {
  if (kind == Overlay::kNone) return Pose::Identity();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d reference = Eigen::Vector3d::Zero(), estimate = Eigen::Vector3d::Zero();
  double count = 0;
  for (const PosePair& pair : pairs) {
    if (count > 0 && pair.time_s >= before_s) break;
    const auto state = state_at(states, pair.time_s);
    if (count > 0 && state && state != TrackingState::kTracking) continue;
    sum += pair.reference.linear() * pair.estimate.linear().transpose();
    reference += pair.reference.translation();
    estimate += pair.estimate.translation();
    ++count;
  }
  Pose mean = Pose::Identity();
  if (kind == Overlay::kYaw) {
    const double yaw = atan2(sum(1, 0) - sum(0, 1), sum(0, 0) + sum(1, 1));
    mean.linear() = rotation_about_z(yaw);
  } else {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
    mean.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  }
  mean.translation() = (reference - mean.linear() * estimate) / count;
  return mean;
}

/// Whether the pose is near the reference and its state, where known, is TRACKING or DEGRADED.
bool is_home(const PosePair& pair, const Pose& alignment, const std::vector<StampedState>& states) {
  if (!claims_to_track(states, pair.time_s)) return false;
  const Pose error = pair.reference.inverse() * (alignment * pair.estimate);
  return metres(error) <= kRecoveredMetres && degrees(error) <= kRecoveredDegrees;
}

std::optional<double> recovery_time(const PosePairs& pairs, const Pose& alignment,
                                    const std::vector<StampedState>& states, double from_s, double to_s) {
  constexpr double kAway = -1;
  double since_s = kAway;  // start of the current run of poses near the reference, s after from_s
  for (const PosePair& pair : pairs) {
    if (pair.time_s < from_s - kSameTime || pair.time_s >= to_s - kSameTime) continue;
    const double now_s = std::max(0.0, pair.time_s - from_s);
    if (!is_home(pair, alignment, states)) {
      since_s = kAway;
    } else if (since_s < 0) {
      since_s = now_s;
    }
    if (since_s >= 0 && now_s - since_s >= kStaysSeconds) break;
  }
  return since_s < 0 ? std::nullopt : std::optional<double>(since_s);
}

int count_wrong_jumps(const PosePairs& pairs, const Pose& alignment, const std::vector<StampedState>& states,
                      const std::vector<Kidnap>& kidnaps) {
  int wrong = 0;
  bool wrong_now = false, beginning = true;
  std::uint32_t epoch = 0;
  double last_error = 0, error_before = 0, kidnapped_s = -std::numeric_limits<double>::infinity();
  auto next = kidnaps.begin();
  const PosePair* before = &pairs.front();
  Pose frame = alignment;
  for (const PosePair& pair : pairs) {
    const PosePair* const last = std::exchange(before, &pair);
    for (; next != kidnaps.end() && next->time_s <= pair.time_s + kSameTime; ++next)
      kidnapped_s = next->time_s;
    const auto state = state_at(states, pair.time_s);
    double error = metres(pair.reference.inverse() * (frame * pair.estimate));
    const double step = error - std::exchange(error_before, error);
    // The error of the first poses, while INITIALISING, is the baseline: the alignment uses later poses, too,
    // and may place the start wrongly.
    beginning = beginning && state == TrackingState::kInitialising;
    if (beginning) last_error = error;
    if (state == TrackingState::kDegraded) {  // drift along a degenerate axis is expected; a jump is not
      if (step < kRise) last_error += step;
      continue;
    }
    if (state != TrackingState::kTracking) {
      wrong_now = false;  // the estimate itself reports that it is lost
      continue;
    }
    // An estimate that begins a new epoch without a jump continues in a new map, which has no pose in the old
    // one: from here on it is compared in the frame of the new map.
    const std::uint32_t epoch_now = said_at(states, pair.time_s)->epoch;
    const Pose way = last->reference.inverse() * pair.reference;
    const Pose said = last->estimate.inverse() * pair.estimate;
    if (std::exchange(epoch, epoch_now) != epoch_now) {
      const bool jumped = metres(way.inverse() * said) > kRise;
      frame = jumped ? alignment : pair.reference * pair.estimate.inverse();
      if (!jumped) error = last_error = error_before = 0;
    }
    if (pair.time_s - kidnapped_s < kNoticedSeconds) continue;
    if (!wrong_now && error > kWrongMetres && error > last_error + kRise) {
      ++wrong;
      wrong_now = true;
    }
    wrong_now = wrong_now && error > kWrongMetres;
    if (!wrong_now) last_error = error;
  }
  return wrong;
}

}  // namespace

std::vector<Kidnap> find_kidnaps(const Trajectory& reference) {
  std::vector<Kidnap> kidnaps;
  Vector6 velocity = Vector6::Zero();
  bool known = false;  // whether `velocity` is known
  for (std::size_t i = 1; i < reference.size(); ++i) {
    const double dt = reference[i].time_s - reference[i - 1].time_s;
    if (!(dt > 0)) continue;
    const Pose step = reference[i - 1].pose.inverse() * reference[i].pose;
    const Pose surprise = known ? se3_exp(dt * velocity).inverse() * step : step;
    // The speed at the start is not known: up to 100 m/s and 10 rad/s are permitted.
    const double metres_allowed = kJumpMetres + 0.5 * kAcceleration * dt * dt + (known ? 0 : 100 * dt);
    const double degrees_allowed =
        (kJumpAngle + 0.5 * kAngularAcceleration * dt * dt + (known ? 0 : 10 * dt)) / kDegree;
    if (metres(surprise) > metres_allowed || degrees(surprise) > degrees_allowed) {
      kidnaps.push_back({i, reference[i].time_s, metres(surprise), degrees(surprise), std::nullopt});
      known = false;  // the velocity is unknown after a kidnap: the robot may face another way
      continue;
    }
    velocity = se3_log(step) / dt;
    known = true;
  }
  return kidnaps;
}

double first_kidnap_s(const std::vector<Kidnap>& kidnaps) {
  return kidnaps.empty() ? std::numeric_limits<double>::infinity() : kidnaps.front().time_s - kSameTime;
}

std::optional<TrackingState> state_at(const std::vector<StampedState>& states, double time_s) {
  const StampedState* found = said_at(states, time_s);
  return found != nullptr ? std::optional<TrackingState>(found->state) : std::nullopt;
}

bool claims_to_track(const std::vector<StampedState>& states, double time_s) {
  if (states.empty()) return true;
  const auto state = state_at(states, time_s);
  return state == TrackingState::kTracking || state == TrackingState::kDegraded;
}

KidnapReport examine_kidnaps(const Trajectory& reference, const PosePairs& pairs,
                             const std::vector<StampedState>& states, Overlay kind) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  KidnapReport report;
  report.kidnaps = find_kidnaps(reference);
  const double first_s = first_kidnap_s(report.kidnaps);
  report.reference_from_estimate = mean_alignment(pairs, states, first_s, kind);
  for (std::size_t i = 0; i < report.kidnaps.size(); ++i) {
    const double next_s = i + 1 < report.kidnaps.size() ? report.kidnaps[i + 1].time_s : kNever;
    report.kidnaps[i].recovery_s =
        recovery_time(pairs, report.reference_from_estimate, states, report.kidnaps[i].time_s, next_s);
  }
  if (!states.empty())
    report.wrong_jumps = count_wrong_jumps(pairs, report.reference_from_estimate, states, report.kidnaps);
  return report;
}

}  // namespace scanlock
