// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/given_ground.hpp"

#include <algorithm>

namespace scanlock {

void GivenGround::follow(const KeyframeArchive& archive, double voxel, Odometer* odometer) {
  const Eigen::Vector3d here = odometer->state().pose.translation();
  if ((at_ - here).norm() < within_) return;
  const std::vector<ArchivedKeyframe>& archived = archive.keyframes();
  const auto own = archived.begin() + static_cast<std::ptrdiff_t>(archive.fixed());
  const bool shown = std::any_of(archived.begin(), own, [&](const ArchivedKeyframe& k) {
    return (k.map_from_body.translation() - here).norm() < static_cast<double>(k.reach);
  });
  if (!shown) {
    // All given keyframes are out of range by now: on return they are loaded again.
    if (!odometer->map().is_founded()) forget();
    return;
  }
  at_ = here;
  within_ = kSameSpot * archive.scene(here);  // set before unreadable points throw: no retry at each scan
  const double farthest = odometer->found_on(archived, archive.fixed(), voxel);
  within_ = std::max(within_, kSameSpot * farthest);
  odometer->set_drift(Matrix6::Zero());
}

}  // namespace scanlock
