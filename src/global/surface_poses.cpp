// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/surface_poses.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "geometry/rigid_fit.hpp"
#include "global/attitude_search.hpp"
#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

constexpr double kSteepMatch = 0.7;    // horizontal part of a normal
constexpr std::size_t kGlance = 100;   // points, of every pose,
constexpr std::size_t kLook = 600;     // and of the best of them
constexpr std::size_t kLooked = 1000;  // poses
constexpr std::size_t kMostGlances = 40000;

struct Candidate {
  double score;
  Pose pose;
};

void best_first(std::vector<Candidate>* candidates) {
  std::stable_sort(candidates->begin(), candidates->end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
}

}  // namespace

std::vector<Pose> surface_poses(const std::vector<SurfaceMatch>& matches, const std::vector<Pose>& guesses,
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
  for (const Pose& pose : guesses) candidates.push_back({score(glance(source, target, pose, kGlance)), pose});
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
