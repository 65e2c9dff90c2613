// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/join.hpp"

namespace scanlock {

void join(const Excursion& excursion, const Pose& map_from_predicted, double reach,
          KeyframeArchive* archive) {
  if (archive->empty()) return;
  const KeyframeArchive known = *archive;
  const Matrix6 covariance = excursion.odometer().drift() + excursion.odometer().pose_covariance();
  std::uint32_t seen_before = 0, added_before = 0;  // ids; 0: none
  for (const ArchivedKeyframe& k : excursion.seen().keyframes()) {
    const Pose here = renormalised(map_from_predicted * k.map_from_body);
    const ArchivedKeyframe& near = known.nearest(here.translation());
    if ((near.map_from_body.translation() - here.translation()).norm() < kSameSpot * reach) continue;
    const Matrix6 back = adjoint(k.map_from_body.inverse() * excursion.state().pose);
    Constraint tie = tie_to(near, here, back * covariance * back.transpose());
    if (k.tie && added_before > 0 && k.tie->from == seen_before) {
      tie = *k.tie;
      tie.from = added_before;
    }
    archive->add(k.utime, here, static_cast<double>(k.reach), *k.points.cloud(), tie);
    seen_before = k.id;
    added_before = archive->keyframes().back().id;
  }
}

}  // namespace scanlock
