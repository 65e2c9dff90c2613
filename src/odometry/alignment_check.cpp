// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/alignment_check.hpp"

#include <algorithm>

#include "geometry/elementary.hpp"
#include "odometry/kidnap_evidence.hpp"

namespace scanlock {
namespace {

// Squared gap (see squared_gap): the bound in place of kMostGap after a distrusted scan.
constexpr double kMostGapDistrusted = 10;
// Seconds without a trusted scan after which a kidnap is as likely as none. Before, its odds grow with the
// square of the time, because a robot is not carried away in a moment.
constexpr double kEvenAfter = 6;

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

void AlignmentCheck::distrust(bool kidnapped) {
  ++distrusted_scans_;
  looks_alike_ = looks_alike_ || kidnapped;
}

double AlignmentCheck::unseen_s(std::int64_t now) const {
  return 1e-6 * static_cast<double>(now - last_.utime);
}

bool AlignmentCheck::is_plausible(const Attempt& attempt) const {
  return squared_gap(attempt.prior, attempt.alignment.moving) <=
         (distrusted_scans_ > 0 ? kMostGapDistrusted : kMostGap);
}

bool AlignmentCheck::is_trusted(const Attempt& attempt) const {
  return explains(attempt, kJumpScore) && is_plausible(attempt);
}

bool AlignmentCheck::is_kidnapped(std::int64_t now, const PreparedScan& scan, const MotionPrior& expected,
                                  const Attempt& attempt) const {
  if (attempt.health.short_history) return false;
  // Consecutive scans share most of their evidence: after a scan that spoke for a kidnap the odds are even.
  const double prior = looks_alike_ ? 0 : 2 * log(unseen_s(now) / kEvenAfter);
  // Another prediction may explain the motion; it is no evidence of a kidnap where it does not.
  const MovingPose& moving = attempt.alignment.moving;
  KidnapEvidence evidence;
  evidence.squared_gap = std::min(squared_gap(attempt.prior, moving), squared_gap(expected, moving));
  evidence.inlier_ratio = inlier_ratio_to_usual(attempt.health);
  if (prior + most_kidnap_odds(evidence) <= 0) return false;
  evidence.contradiction = contradiction(last_, now, scan, moving);
  return prior + kidnap_log_odds(evidence) > 0;
}

}  // namespace scanlock
