// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/alignment_check.hpp"

#include <algorithm>

namespace scanlock {
namespace {

// Squared gaps (see squared_gap): the bound in place of kMostGap after a distrusted scan, and the one beyond
// which an alignment is unusual. Scans with a lorry close by have 0.5; kidnaps that no other test detects
// mostly have 6 and more.
constexpr double kMostGapDistrusted = 10, kUnusualGap = 1;
// Seconds without a trusted scan, after which right alignments have gaps as large as wrong ones.
constexpr double kMotionTells = 1.2;

double gap(const Attempt& attempt) {
  return squared_gap(attempt.prior, attempt.alignment.moving);
}

}  // namespace

void AlignmentCheck::restart(const Pose& pose, std::int64_t time) {
  last_ = {pose, time, Vector6::Zero(), {}, {}};
  distrusted_scans_ = 0;
}

void AlignmentCheck::trust(std::int64_t now, const PreparedScan& scan, const MovingPose& moving,
                           bool witness) {
  last_ = trusted_scan(now, scan, moving);
  if (!witness) last_.rays = {};
  distrusted_scans_ = 0;
  looks_alike_ = false;
}

void AlignmentCheck::distrust(bool contradicted) {
  ++distrusted_scans_;
  looks_alike_ = looks_alike_ || contradicted;
}

double AlignmentCheck::unseen_s(std::int64_t now) const {
  return 1e-6 * static_cast<double>(now - last_.utime);
}

bool AlignmentCheck::is_plausible(const Attempt& attempt) const {
  return gap(attempt) <= (distrusted_scans_ > 0 ? kMostGapDistrusted : kMostGap);
}

bool AlignmentCheck::is_trusted(const Attempt& attempt) const {
  return explains(attempt, kJumpScore) && is_plausible(attempt);
}

bool AlignmentCheck::is_to_be_confirmed(std::int64_t now, double period_s, const MotionPrior& expected,
                                        const Attempt& attempt) const {
  const double unseen = unseen_s(now);
  return unseen > std::max(kMoment, 1.5 * period_s) && unseen < kMotionTells &&
         !attempt.health.short_history && squared_gap(expected, attempt.alignment.moving) > kUnusualGap;
}

bool AlignmentCheck::is_contradicted(std::int64_t now, const PreparedScan& scan,
                                     const Attempt& attempt) const {
  const bool after_gap = unseen_s(now) > kMoment;
  const double most = after_gap ? kMostContradictionAfterGap : kMostContradiction;
  const bool moved_unusually = looks_alike_ || gap(attempt) > kUnusualGap;
  // A person or a door hides a large part of a planar scan, but does not change the motion.
  const bool unusual = moved_unusually || (!scan.planar && (after_gap || attempt.health.score > kFitScore ||
                                                            !has_usual_inlier_ratio(attempt.health)));
  return unusual && !attempt.health.short_history &&
         contradiction(last_, now, scan, attempt.alignment.moving) > most;
}

}  // namespace scanlock
