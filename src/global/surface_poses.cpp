// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/surface_poses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/elementary.hpp"
#include "geometry/rigid_fit.hpp"
#include "global/attitude_search.hpp"
#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

constexpr double kSteepMatch = 0.7;      // least horizontal part of a normal
constexpr std::size_t kGlimpse = 32;     // points for the first score of every guess
constexpr std::size_t kCoarse = 100;     // points for the coarse score of the best guesses and all matches
constexpr std::size_t kLook = 600;       // points for the score of the best poses of both
constexpr std::size_t kGlanced = 10000;  // number of guesses with a coarse score, at most
constexpr std::size_t kLooked = 1000;    // number of poses scored with kLook points, at most
constexpr std::size_t kMostGlances = 40000;

struct Candidate {
  double score;
  Pose pose;
};

void best_first(std::vector<Candidate>* candidates) {
  std::stable_sort(candidates->begin(), candidates->end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
}

/// The poses, at most kGlanced, at which the most points of the source meet a surface of the target; of poses
/// that meet equally many, all or none.
std::vector<Pose> best_of(const GroundPoses& poses, const CloudCheck& source, const CloudCheck& target) {
  std::vector<std::vector<std::uint16_t>> met;
  std::vector<std::size_t> poses_that_meet(2 * kGlimpse, 0);  // number of poses by number of points
  for (const Eigen::Matrix3d& attitude : poses.attitudes) {
    met.push_back(surfaces_met(source, target, attitude, poses.places, kGlimpse));
    for (std::uint16_t count : met.back()) ++poses_that_meet[count];
  }
  std::size_t enough = poses_that_meet.size(), kept = 0;
  while (enough > 1 && kept + poses_that_meet[enough - 1] <= kGlanced) kept += poses_that_meet[--enough];
  std::vector<Pose> result;
  for (std::size_t i = 0; i < met.size(); ++i) {
    for (std::size_t k = 0; k < met[i].size(); ++k) {
      if (met[i][k] < enough) continue;
      Pose pose = Pose::Identity();
      pose.linear() = poses.attitudes[i];
      pose.translation() = poses.places[k];
      result.push_back(pose);
    }
  }
  return result;
}

}  // namespace

std::vector<Pose> surface_poses(const std::vector<SurfaceMatch>& matches, const GroundPoses& guesses,
                                const CloudCheck& source, const CloudCheck& target,
                                const std::vector<Eigen::Vector3d>& ups, const Eigen::Vector3d& centre,
                                double epsilon, std::size_t count) {
  std::vector<Candidate> candidates;
  // With many attitudes only every n-th match is used, n = stride.
  const std::size_t stride = matches.size() * ups_or_z(ups).size() / kMostGlances + 1;
  for (const Eigen::Vector3d& up : ups_or_z(ups)) {
    const Eigen::Matrix3d level = level_rotation(up);
    for (std::size_t i = 0; i < matches.size(); i += stride) {
      const SurfaceMatch& m = matches[i];
      const Eigen::Vector2d s = m.normal_p.head<2>(), t = (level * m.normal_q).head<2>();
      if (s.norm() < kSteepMatch || t.norm() < kSteepMatch) continue;
      const double yaw = atan2(t.y(), t.x()) - atan2(s.y(), s.x());
      Pose pose = Pose::Identity();
      pose.linear() = level.transpose() * rotation_about_z(yaw);
      pose.translation() = m.q - pose.linear() * m.p;
      candidates.push_back({score(coarse_fit(source, target, pose, kCoarse)), pose});
    }
  }
  for (const Pose& pose : best_of(guesses, source, target))
    candidates.push_back({score(coarse_fit(source, target, pose, kCoarse)), pose});
  best_first(&candidates);
  candidates.resize(std::min(candidates.size(), kLooked));
  for (Candidate& c : candidates) c.score = score(coarse_fit(source, target, c.pose, kLook));
  best_first(&candidates);
  std::vector<Pose> result;
  for (const Candidate& c : candidates) {
    if (result.size() == count) break;
    const bool known = std::any_of(result.begin(), result.end(), [&](const Pose& other) {
      return separation(other, c.pose, centre, epsilon) < 1;
    });
    if (!known) result.push_back(c.pose);
  }
  return result;
}

}  // namespace scanlock
