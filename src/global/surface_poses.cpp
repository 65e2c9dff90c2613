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

constexpr double kSteepMatch = 0.7;      // horizontal part of a normal
constexpr std::size_t kGlimpse = 32;     // points, of every guess,
constexpr std::size_t kGlance = 100;     // of the best of those and of every match,
constexpr std::size_t kLook = 600;       // and of the best of all
constexpr std::size_t kGlanced = 10000;  // guesses, and
constexpr std::size_t kLooked = 1000;    // poses that these are
constexpr std::size_t kMostGlances = 40000;

struct Candidate {
  double score;
  Pose pose;
};

void best_first(std::vector<Candidate>* candidates) {
  std::stable_sort(candidates->begin(), candidates->end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
}

/// Those at which the most of the source's surfaces meet one of the target's; of those that meet equally many
/// all or none.
std::vector<Pose> best_of(const StandPoses& poses, const CloudCheck& source, const CloudCheck& target) {
  std::vector<std::vector<std::uint16_t>> met;
  std::vector<std::size_t> poses_that_meet(2 * kGlimpse, 0);  // so many
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

std::vector<Pose> surface_poses(const std::vector<SurfaceMatch>& matches, const StandPoses& guesses,
                                const CloudCheck& source, const CloudCheck& target,
                                const std::vector<Eigen::Vector3d>& ups, const Eigen::Vector3d& centre,
                                double epsilon, std::size_t count) {
  std::vector<Candidate> candidates;
  // In many attitudes every so many of the matches have to do.
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
      candidates.push_back({score(glance(source, target, pose, kGlance)), pose});
    }
  }
  for (const Pose& pose : best_of(guesses, source, target))
    candidates.push_back({score(glance(source, target, pose, kGlance)), pose});
  best_first(&candidates);
  candidates.resize(std::min(candidates.size(), kLooked));
  for (Candidate& c : candidates) c.score = score(glance(source, target, c.pose, kLook));
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
