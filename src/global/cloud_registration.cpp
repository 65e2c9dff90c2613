// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/rigid_fit.hpp"
#include "global/cpu_clock.hpp"
#include "icp/cloud_alignment.hpp"

namespace scanlock {
namespace {

constexpr double kEpsilonOfVoxel = 0.75;
constexpr double kRivalEpsilons = 4, kRivalAngle = 0.1;
constexpr int kFewestMatches = 8;  // consensus below which nothing is believed
constexpr double kLeastOverlap = 0.25, kMostContradiction = 0.2;
constexpr double kClearMargin = 1.5, kSlimMargin = 1.2;
constexpr double kCrowd = 0.5;  // of epsilon
constexpr int kRounds = 10;
constexpr std::size_t kManyKeypoints = 300;
constexpr double kRivalOverlap = 0.85;  // of the best pose's

/// Least squares over weighted matches, of rotations about the vertical and translations.
Pose level_fit(const Matches& matches, const std::vector<std::uint32_t>& inliers,
               const std::vector<double>& weights) {
  PairSums sums;
  for (std::size_t k = 0; k < inliers.size(); ++k)
    sums.add(weights[k], matches[inliers[k]].p, matches[inliers[k]].q);
  Pose pose = Pose::Identity();
  if (!(sums.weight > 0)) return pose;
  const Eigen::Vector3d p = sums.p / sums.weight, q = sums.q / sums.weight;
  const Eigen::Matrix3d moment = sums.qp / sums.weight - q * p.transpose();
  const double yaw = std::atan2(moment(1, 0) - moment(0, 1), moment(0, 0) + moment(1, 1));
  pose.linear() = so3_exp(Eigen::Vector3d(0, 0, yaw));
  pose.translation() = q - pose.linear() * p;
  return pose;
}

/// The same with the targets turned.
Matches levelled(Matches matches, const Eigen::Matrix3d& level) {
  for (Match& match : matches) match.q = level * match.q;
  return matches;
}

/// The pose in the middle of the inliers: the right ones crowd about it, and what is within epsilon by chance
/// does not, so matches count less the farther they are (Welsch's weights).
Pose middle_pose(const Matches& matches, const std::vector<std::uint32_t>& inliers, double epsilon) {
  std::vector<double> weights(inliers.size(), 1.0);
  Pose pose = level_fit(matches, inliers, weights);
  const double scale = kCrowd * epsilon;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < inliers.size(); ++k) {
      const Match& match = matches[inliers[k]];
      weights[k] = std::exp(-(pose * match.p - match.q).squaredNorm() / (2 * scale * scale));
    }
    pose = level_fit(matches, inliers, weights);
  }
  return pose;
}

/// Every n-th keypoint.
CloudDescription part(const CloudDescription& whole, std::size_t stride) {
  CloudDescription result;
  result.points = whole.points;
  result.voxel = whole.voxel;
  const std::size_t count = (whole.keypoints.size() + stride - 1) / stride;
  result.descriptors.resize(static_cast<Eigen::Index>(count), whole.descriptors.cols());
  for (std::size_t k = 0; k < count; ++k) {
    result.keypoints.push_back(whole.keypoints[k * stride]);
    result.descriptors.row(static_cast<Eigen::Index>(k)) =
        whole.descriptors.row(static_cast<Eigen::Index>(k * stride));
  }
  return result;
}

/// The same points, described anew.
CloudDescription redescribed(const CloudDescription& old, double feature_radius, std::size_t keypoints) {
  DescriptionOptions options = old.options;
  options.voxel = old.voxel;
  options.feature_radius = feature_radius;
  options.keypoints = keypoints;
  return describe(old.points, options);
}

/// How far apart two poses put the source, as a share of what counts as another pose.
double separation(const Pose& a, const Pose& b, const Eigen::Vector3d& centre, double epsilon) {
  const double distance = (a * centre - b * centre).norm();
  const double angle = so3_log(a.linear().transpose() * b.linear()).norm();
  return std::max(distance / (kRivalEpsilons * epsilon), angle / kRivalAngle);
}

/// The clouds of one registration, indexed once for all attempts.
class Registrar {
 public:
  Registrar(const CloudDescription& source, const CloudDescription& target,
            const CloudRegistrationOptions& options)
      : source_(source), target_(target), options_(options) {
    result_.epsilon = options.epsilon > 0 ? options.epsilon : kEpsilonOfVoxel * source.voxel;
    for (std::size_t i = 0; i < source.points.size(); ++i) centre_ += source.points.point(i).cast<double>();
    if (!source.points.empty()) centre_ /= static_cast<double>(source.points.size());
  }

  CloudRegistration run();

 private:
  void attempt(const CloudDescription& source, const CloudDescription& target);
  void solve(const Matches& matches, MatchRegistrationOptions search);
  void look_closer();
  Pose refined(const Pose& start, std::uint32_t* degenerate_axes);
  bool confirmed(const CloudFit& fit) const {
    return fit.overlap >= kLeastOverlap && fit.contradiction <= kMostContradiction;
  }
  void judge();

  const CloudDescription &source_, &target_;
  CloudRegistrationOptions options_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();     // of the source, metres
  Eigen::Matrix3d level_ = Eigen::Matrix3d::Identity();  // of the target, in which the solution is level
  Matches all_matches_;                                  // of all keypoints; drawn when first needed
  std::optional<CloudTarget> index_;
  std::optional<CloudCheck> source_check_, target_check_;
  CloudRegistration result_;
};

/// Keeps the start when the clouds would carry the pose away from it: that is no refinement.
Pose Registrar::refined(const Pose& start, std::uint32_t* degenerate_axes) {
  if (!index_) {
    index_.emplace(target_.points);
    index_->prepare_normals();
  }
  CloudAlignmentOptions alignment;
  alignment.nu_max = result_.epsilon;
  alignment.nu_min = std::max(index_->point_nu_min(), index_->plane_nu_min());
  for (const char* method : {"robust-icp-plane", "robust-icp"}) {
    const CloudAlignment aligned =
        align_clouds(source_.points, *index_, start, *find_cloud_method(method), alignment);
    *degenerate_axes = aligned.degenerate_axes;
    if (separation(aligned.target_from_source, start, centre_, result_.epsilon) < 1)
      return aligned.target_from_source;
  }
  return start;
}

/// The best over the directions that may be up, and the best of the others that is elsewhere.
void Registrar::solve(const Matches& matches, MatchRegistrationOptions search) {
  level_.setIdentity();
  if (options_.target_ups.empty()) {
    result_.solution = register_matches(matches, search);
    return;
  }
  MatchRegistration best;
  for (const Eigen::Vector3d& up : options_.target_ups) {
    const Eigen::Matrix3d level =
        Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    search.at_least = std::max(kFewestMatches, static_cast<int>(std::ceil(best.consensus / kSlimMargin)));
    MatchRegistration found = register_matches(levelled(matches, level), search);
    for (Pose* pose : {&found.target_from_source, &found.runner_up}) *pose = level.transpose() * *pose;
    const std::size_t nodes = best.nodes + found.nodes;
    const double pruning_ms = best.pruning_ms + found.pruning_ms,
                 search_ms = best.search_ms + found.search_ms;
    if (found.consensus > best.consensus) {
      std::swap(found, best);
      level_ = level;
    }
    // What the loser leaves open, and where it would rather be.
    best.upper_bound = std::max(best.upper_bound, found.upper_bound);
    best.certified = best.consensus > 0 && best.upper_bound == best.consensus;
    if (found.consensus > best.runner_up_consensus &&
        separation(found.target_from_source, best.target_from_source, centre_, result_.epsilon) >= 1) {
      best.runner_up = found.target_from_source;
      best.runner_up_consensus = found.consensus;
      best.runner_up_bound = std::max(best.runner_up_bound, found.upper_bound);
    }
    best.nodes = nodes;
    best.pruning_ms = pruning_ms;
    best.search_ms = search_ms;
  }
  result_.solution = best;
}

void Registrar::attempt(const CloudDescription& source, const CloudDescription& target) {
  CpuClock clock;
  const Matches matches = match(source, target, options_.lambda);
  result_.matching_ms += clock.lap();
  MatchRegistrationOptions search;
  search.epsilon = result_.epsilon;
  search.tilt = options_.tilt;
  search.max_nodes = options_.max_nodes;
  search.budget_s = options_.budget_s;
  search.rival_distance = kRivalEpsilons * result_.epsilon;
  search.rival_angle = kRivalAngle;
  solve(matches, search);
  ++result_.attempts;
  result_.start = result_.target_from_source = result_.solution.target_from_source;
  result_.fit = result_.runner_up_fit = CloudFit{};
  result_.same_peak = false;
  if (result_.solution.consensus >= kFewestMatches) look_closer();
}

/// Makes the pose of the matches precise with more matches, then with the clouds, and compares the clouds.
void Registrar::look_closer() {
  CpuClock clock;
  if (all_matches_.empty()) all_matches_ = match(source_, target_, options_.lambda);
  std::vector<std::uint32_t> near;
  const Pose& pose = result_.solution.target_from_source;
  for (std::uint32_t i = 0; i < all_matches_.size(); ++i) {
    if ((pose * all_matches_[i].p - all_matches_[i].q).norm() <= result_.epsilon) near.push_back(i);
  }
  if (near.size() >= kFewestMatches)
    result_.start = level_.transpose() * middle_pose(levelled(all_matches_, level_), near, result_.epsilon);
  result_.matching_ms += clock.lap();
  if (!source_check_) source_check_.emplace(source_.points, source_.voxel);
  if (!target_check_) target_check_.emplace(target_.points, target_.voxel);
  result_.target_from_source = refined(result_.start, &result_.degenerate_axes);
  result_.fit = compare(*source_check_, *target_check_, result_.target_from_source);
  std::uint32_t unused = 0;
  const Pose rival = refined(result_.solution.runner_up, &unused);
  result_.same_peak = separation(rival, result_.target_from_source, centre_, result_.epsilon) < 0.5;
  result_.runner_up_fit = compare(*source_check_, *target_check_, rival);
  result_.refinement_ms += clock.lap();
}

void Registrar::judge() {
  const MatchRegistration& s = result_.solution;
  const double margin = static_cast<double>(s.consensus) / std::max(1, s.runner_up_bound);
  const bool rival = !result_.same_peak && confirmed(result_.runner_up_fit) &&
                     result_.runner_up_fit.overlap > kRivalOverlap * result_.fit.overlap;
  if (s.consensus < kFewestMatches || !confirmed(result_.fit)) {
    result_.verdict = GlobalVerdict::kNoOverlap;
  } else if (result_.degenerate_axes != 0 || rival || (!result_.same_peak && margin < kSlimMargin)) {
    result_.verdict = GlobalVerdict::kAmbiguous;
  } else {
    result_.verdict = s.certified ? GlobalVerdict::kCertain : GlobalVerdict::kUncertified;
  }
}

CloudRegistration Registrar::run() {
  for (int round = 0; round < options_.attempts; ++round) {
    if (round == 0 && source_.keypoints.size() > kManyKeypoints) {
      attempt(part(source_, 2), part(target_, 2));
    } else if (round < 2) {
      attempt(source_, target_);
    } else {
      attempt(redescribed(source_, 9, 800), redescribed(target_, 9, 800));
    }
    judge();
    if (result_.verdict == GlobalVerdict::kCertain) break;
  }
  return result_;
}

}  // namespace

const char* verdict_name(GlobalVerdict verdict) {
  switch (verdict) {
    case GlobalVerdict::kCertain:
      return "certain";
    case GlobalVerdict::kAmbiguous:
      return "ambiguous";
    case GlobalVerdict::kNoOverlap:
      return "no overlap";
    case GlobalVerdict::kUncertified:
      return "uncertified";
  }
  return "";
}

CloudRegistration register_clouds(const CloudDescription& source, const CloudDescription& target,
                                  const CloudRegistrationOptions& options) {
  if (source.voxel > 0 && target.voxel > 0 && source.voxel != target.voxel)
    throw std::invalid_argument("register_clouds: the descriptions have different voxels");
  return Registrar(source, target, options).run();
}

}  // namespace scanlock
