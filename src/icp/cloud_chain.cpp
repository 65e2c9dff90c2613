// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_chain.hpp"

#include <utility>

#include "icp/cloud_thinning.hpp"

namespace scanlock {

CloudChain::CloudChain(const CloudMethod& method, const CloudAlignmentOptions& options,
                       std::optional<double> voxel)
    : method_(method), options_(options), voxel_(voxel) {}

CloudChain::~CloudChain() = default;

Pose CloudChain::likely_motion(const PointCloud& source) const {
  const bool carried_on = misfit(source, *target_, last_motion_) < misfit(source, *target_, Pose::Identity());
  return carried_on ? last_motion_ : Pose::Identity();
}

std::optional<CloudAlignment> CloudChain::add(const PointCloud& cloud,
                                              const std::optional<ChainGuess>& guess) {
  const double own_voxel = voxel_ ? *voxel_ : sensible_voxel(cloud);
  auto own = std::make_unique<CloudTarget>(thinned_by(cloud, own_voxel), options_.threads);
  if (method_.needs_normals() || options_.start_may_be_better) {
    own->prepare_normals(options_.threads, nullptr, CloudTarget::normal_neighbours(own_voxel));
  }

  std::optional<CloudAlignment> alignment;
  if (target_) {
    const PointCloud source = thinned_by(cloud, target_voxel_);
    CloudAlignmentOptions options = options_;
    options.voxel = target_voxel_;
    options.start_may_be_better = options.start_may_be_better && guess;
    if (guess && guess->nu_max > 0) options.nu_max = guess->nu_max;
    alignment.emplace();
    alignment->target_from_source = guess ? guess->target_from_source : likely_motion(source);
    if (!guess || guess->refined)
      alignment = align_clouds(source, *target_, alignment->target_from_source, method_, options);
    last_motion_ = alignment->target_from_source;
  }
  poses_.push_back(poses_.empty() ? Pose::Identity() : renormalised(poses_.back() * last_motion_));
  target_ = std::move(own);
  target_voxel_ = own_voxel;
  return alignment;
}

}  // namespace scanlock
