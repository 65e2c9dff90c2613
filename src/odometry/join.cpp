// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/join.hpp"

namespace scanlock {

void join(const LostModeOdometry& lost_odometry, const Pose& map_from_predicted, double reach,
          KeyframeArchive* archive) {
  if (archive->empty()) return;
  const KeyframeArchive known = *archive;
  const Matrix6 covariance = lost_odometry.odometer().drift() + lost_odometry.odometer().pose_covariance();
  std::uint32_t seen_before = 0, added_before = 0;  // ids; 0: none
  for (const ArchivedKeyframe& k : lost_odometry.seen().keyframes()) {
    const Pose here = renormalised(map_from_predicted * k.map_from_body);
    const ArchivedKeyframe& near = known.nearest(here.translation());
    if ((near.map_from_body.translation() - here.translation()).norm() < kSameSpot * reach) continue;
    const Matrix6 back = adjoint(k.map_from_body.inverse() * lost_odometry.state().pose);
    Constraint constraint = constraint_to(near, here, back * covariance * back.transpose());
    if (k.constraint && added_before > 0 && k.constraint->from == seen_before) {
      constraint = *k.constraint;
      constraint.from = added_before;
    }
    archive->add(k.utime, here, static_cast<double>(k.reach), *k.points.cloud(), constraint);
    seen_before = k.id;
    added_before = archive->keyframes().back().id;
  }
}

}  // namespace scanlock
