// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_pair.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "geometry/rigid_fit.hpp"
#include "global/attitude_search.hpp"
#include "global/cpu_clock.hpp"
#include "global/ground_poses.hpp"
#include "global/surface_poses.hpp"
#include "icp/cloud_selection.hpp"

namespace scanlock {
namespace {

constexpr double kHopeless = 0.5;                 // contradiction that excludes a refinement
constexpr double kCrowd = 0.35, kCrowdReach = 2;  // least scale, in epsilons; largest distance, in scales
constexpr int kCrowdRounds = 8;
constexpr double kStillFits = 0.95;  // of the overlap of the unshifted pose
// Source points of a refinement unless `judged`: accuracy of some centimetres is enough to compare fits.
constexpr std::size_t kRefinedPoints = 2000;

}  // namespace

CloudPair::CloudPair(const CloudDescription& source, const CloudDescription& target, double epsilon,
                     bool judged, const CloudCheck* target_check)
    : source_(source), target_(target), epsilon_(epsilon), judged_(judged), target_check_(target_check) {
  for (std::size_t i = 0; i < source.points.size(); ++i) centre_ += source.points.point(i).cast<double>();
  if (!source.points.empty()) centre_ /= static_cast<double>(source.points.size());
}

double CloudPair::separation(const Pose& a, const Pose& b) const {
  return scanlock::separation(a, b, centre_, epsilon_);
}

/// The matches of all keypoints. They are too ambiguous for a search; once a pose is known, the right matches
/// are those that agree with it.
const std::vector<SurfaceMatch>& CloudPair::all_matches() {
  if (matches_.empty()) matches_ = match_surfaces(source_, target_, kMostMatches);
  return matches_;
}

Matches CloudPair::matches(int lambda) {
  CpuClock clock;
  Matches result;
  for (const SurfaceMatch& m : all_matches())
    if (m.rank <= lambda) result.push_back({m.p, m.q});
  matching_ms_ += clock.lap();
  return result;
}

/// Fits the pose to all matches near it. Welsch's weights decrease with the distance, because matches that
/// are within epsilon by chance are spread over all of that range. Returns the start when the fit leads to a
/// different hypothesis, whose matches these then are.
Pose CloudPair::middle_pose(const Pose& start) {
  Pose pose = start;
  const Eigen::Matrix3d level = level_rotation(pose.linear().col(2));
  for (int round = 0; round < kCrowdRounds; ++round) {
    const double scale = std::max(kCrowd, 1.0 - kCrowd * round) * epsilon_;
    PairSums sums;
    int near = 0;
    for (const SurfaceMatch& m : all_matches()) {
      const double squared = (pose * m.p - m.q).squaredNorm();
      if (squared > kCrowdReach * kCrowdReach * scale * scale) continue;
      sums.add(exp(-squared / (2 * scale * scale)), m.p, level * m.q);
      ++near;
    }
    if (near < kFewestMatches) break;
    pose = level.transpose() * level_fit(sums);
    if (separation(pose, start) >= 1) return start;
  }
  return pose;
}

/// The pose near `pose` at which the surfaces of all matches meet. (Only if `judged`: the criteria of callers
/// that decide themselves were determined with middle_pose().)
Pose CloudPair::surface_pose(const Pose& pose) {
  return fit_surfaces(all_matches(), pose, centre_, epsilon_);
}

/// Refines the start with the clouds. A result that is a different hypothesis is rejected if `judged`;
/// otherwise it is accepted if the clouds fit better there than `at_start`, as where the body stands on
/// another slope.
Pose CloudPair::refined(const Pose& start, const CloudFit& at_start, std::uint32_t* degenerate_axes) {
  if (!index_) {
    index_.emplace(target_.points);
    index_->prepare_normals();
    if (!judged_) some_of_source_ = thinned(source_.points, kRefinedPoints);
  }
  const PointCloud& points = judged_ ? source_.points : some_of_source_;
  CloudAlignmentOptions alignment;
  alignment.nu_max = epsilon_;
  alignment.nu_min = std::max(index_->point_nu_min(), index_->plane_nu_min());
  for (const char* method : {"robust-icp-plane", "robust-icp"}) {
    const CloudAlignment aligned =
        align_clouds(points, *index_, start, *find_cloud_method(method), alignment);
    *degenerate_axes = aligned.degenerate_axes;
    const Pose& pose = aligned.target_from_source;
    if (separation(pose, start) < 1 || (!judged_ && score(fit(pose)) > score(at_start))) return pose;
  }
  return start;
}

Hypothesis CloudPair::examine(const Pose& pose, int consensus, bool first) {
  CpuClock clock;
  Hypothesis hypothesis;
  hypothesis.consensus = consensus;
  hypothesis.start = hypothesis.refined = judged_ ? surface_pose(pose) : middle_pose(pose);
  matching_ms_ += clock.lap();
  compare_clouds(first, &hypothesis);
  refinement_ms_ += clock.lap();
  return hypothesis;
}

std::vector<Pose> CloudPair::likely_poses(const std::vector<Eigen::Vector3d>& ups, std::size_t count) {
  CpuClock clock;
  index_clouds();
  std::vector<Pose> poses = surface_poses(
      all_matches(), ground_poses(source_.points, target_.points, target_check_->space(), source_.voxel, ups),
      *source_check_, *target_check_, ups, centre_, epsilon_, count);
  matching_ms_ += clock.lap();
  return poses;
}

void CloudPair::index_clouds() {
  if (!source_check_) source_check_.emplace(source_.points, source_.voxel);
  if (!target_check_) target_check_ = &own_target_check_.emplace(target_.points, target_.voxel);
}

CloudFit CloudPair::fit(const Pose& pose) const {
  const auto whose = judged_ ? ContradictionOf::kWorse : ContradictionOf::kSource;
  return compare(*source_check_, *target_check_, pose, whose);
}

void CloudPair::compare_clouds(bool first, Hypothesis* hypothesis) {
  index_clouds();
  if (!first || !judged_) hypothesis->fit = fit(hypothesis->start);
  if (!first && hypothesis->fit.contradiction >= kHopeless) return;
  hypothesis->refined = refined(hypothesis->start, hypothesis->fit, &hypothesis->degenerate_axes);
  hypothesis->fit = fit(hypothesis->refined);
  // Along a direction that the surfaces of the matches do not constrain, the refined pose is more accurate
  // than the first matches.
  if (judged_)
    hypothesis->start =
        surface_pose(levelled(hypothesis->refined, hypothesis->start.linear().col(2), centre_));
}

bool CloudPair::slides(const Hypothesis& hypothesis) const {
  const Eigen::Vector3d step =
      kRunnerUpEpsilons * epsilon_ * (hypothesis.refined.linear() * source_check_->loose_direction());
  const auto fits = [&](const Eigen::Vector3d& shift) {
    Pose shifted = hypothesis.refined;
    shifted.translation() += shift;
    const CloudFit there = fit(shifted);
    return there.overlap >= kStillFits * hypothesis.fit.overlap && there.contradiction <= kClearContradiction;
  };
  return fits(step) || fits(-step);
}

}  // namespace scanlock
