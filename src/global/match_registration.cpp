// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/match_registration.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>

#include "geometry/elementary.hpp"
#include "global/cpu_clock.hpp"
#include "global/pose_search.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

void check(const Matches& matches, const MatchRegistrationOptions& options) {
  const auto require = [](bool good, const char* sentence) {
    if (!good) throw std::invalid_argument(sentence);
  };
  require(options.epsilon > 0 && std::isfinite(options.epsilon),
          "epsilon must be a number of metres above 0");
  require(options.up.allFinite() && options.up.norm() > 0,
          "the up axis must be a finite vector other than 0");
  require(options.tilt >= 0 && options.tilt <= 0.5, "the tilt must be between 0 and 0.5 radians");
  require(options.budget_s >= 0, "the budget must be 0 seconds or more");
  require(options.rival_distance >= 0 && options.rival_angle >= 0,
          "the rival distance and angle must be 0 or more");
  require(matches.size() < std::numeric_limits<std::uint32_t>::max() / 2, "there are too many matches");
  constexpr double kLargest = 1e9;  // squares and grids of coordinates beyond have no meaning in metres
  for (std::size_t i = 0; i < matches.size(); ++i) {
    // NaN fails the comparison.
    if (!(matches[i].p.cwiseAbs().maxCoeff() <= kLargest && matches[i].q.cwiseAbs().maxCoeff() <= kLargest) ||
        !matches[i].p.allFinite() || !matches[i].q.allFinite())
      throw std::invalid_argument("match " + std::to_string(i) +
                                  " has a coordinate that is not finite or beyond 1e9 m");
  }
}

/// From the caller's coordinates to the solver's: z up, both sides about their centres.
struct Frame {
  Eigen::Matrix3d level = Eigen::Matrix3d::Identity();  // turns `up` to z
  Eigen::Vector3d p_centre = Eigen::Vector3d::Zero(),
                  q_centre = Eigen::Vector3d::Zero();  // in the caller's axes

  Pose pose(const LevelPose& found) const {
    Pose result = Pose::Identity();
    result.linear() = level.transpose() * rotation_about_z(found.theta) * level;
    result.translation() = q_centre + level.transpose() * Eigen::Vector3d(found.x, found.y, found.z) -
                           result.linear() * p_centre;
    return result;
  }

  LevelPose level_pose(const Pose& pose) const {
    const Eigen::Matrix3d turn = level * pose.linear() * level.transpose();
    const Eigen::Vector3d way = level * (pose.translation() + pose.linear() * p_centre - q_centre);
    return {atan2(turn(1, 0), turn(0, 0)), way.x(), way.y(), way.z()};
  }
};

Frame frame_of(const Matches& matches, const Eigen::Vector3d& up) {
  Frame frame;
  const Eigen::Vector3d axis = up.normalized();
  if (axis != Eigen::Vector3d::UnitZ()) frame.level = level_rotation(axis);
  for (const Match& match : matches) {
    frame.p_centre += match.p;
    frame.q_centre += match.q;
  }
  const double n = static_cast<double>(std::max<std::size_t>(matches.size(), 1));
  frame.p_centre /= n;
  frame.q_centre /= n;
  return frame;
}

LevelMatches levelled(const Matches& matches, const Frame& frame, const MatchRegistrationOptions& options) {
  LevelMatches result;
  result.reserve(matches.size());
  const double tilt = 4 * sin(0.5 * options.tilt);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Vector3d p = frame.level * (matches[i].p - frame.p_centre);
    const Eigen::Vector3d q = frame.level * (matches[i].q - frame.q_centre);
    result.px.push_back(p.x());
    result.py.push_back(p.y());
    result.qx.push_back(q.x());
    result.qy.push_back(q.y());
    result.dz.push_back(q.z() - p.z());
    result.threshold.push_back(options.epsilon + tilt * p.norm());
    result.original.push_back(static_cast<std::uint32_t>(i));
  }
  return sorted_by_height(result);
}

SearchLimits limits_of(const MatchRegistrationOptions& options) {
  SearchLimits limits;
  limits.nodes = options.max_nodes;
  limits.work = options.max_work;
  limits.progress = options.progress;
  constexpr double kForever = 1e9;
  if (options.budget_s < kForever) {
    limits.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                         std::chrono::duration<double>(options.budget_s));
  }
  return limits;
}

/// First a pose by a little best-first search, if weak ones are wanted, then a bound on all others. A rival
/// of less than half the consensus is none, so the bound need not come below that; and the effort is bounded,
/// for the runner-up is harder to prove than the answer.
void seek_runner_up(const LevelMatches& matches, const LevelPose& first,
                    const MatchRegistrationOptions& options, const Frame& frame, SearchLimits limits,
                    MatchRegistration& result) {
  constexpr std::size_t kLeastWork = 200'000, kMostWork = 4'000'000;
  const std::size_t work = limits.work;
  const ExcludedPoses excluded{first, options.rival_angle, options.rival_distance};
  Incumbent rival;
  int bound = result.upper_bound;
  bool finished = false;
  if (options.weak_runner_up) {
    limits.work = std::min(work, kLeastWork);
    const SearchResult quick = search_poses(matches, rival, limits, excluded);
    bound = quick.upper_bound;
    finished = quick.finished;
  }
  if (!finished) {
    Incumbent better = rival;
    better.consensus = std::max(rival.consensus, result.consensus / 2);
    const int known = better.consensus;
    limits.work = std::min(work, std::max(kMostWork, 2 * result.work));
    bound = std::min(bound, search_poses(matches, better, limits, excluded).upper_bound);
    if (better.consensus > known) rival = better;
  }
  result.runner_up = frame.pose(rival.pose);
  result.runner_up_consensus = rival.consensus;
  result.runner_up_bound = std::min(bound, result.upper_bound);
}

}  // namespace

MatchRegistration register_matches(const Matches& matches, const MatchRegistrationOptions& options) {
  check(matches, options);
  MatchRegistration result;
  result.matches = result.matches_after_pruning = matches.size();
  if (matches.empty()) {
    result.certified = true;
    return result;
  }
  SearchLimits limits = limits_of(options);
  CpuClock clock;
  const Frame frame = frame_of(matches, options.up);
  const LevelMatches all = levelled(matches, frame, options);
  LevelMatches pruned;
  const LevelMatches* left = &all;
  Incumbent best;
  best.consensus = std::max(0, options.at_least - 1);
  int bound = static_cast<int>(matches.size());
  if (options.prune) {
    std::vector<std::uint32_t> kept;
    const SearchResult pruning = prune_matches(all, best, kept, limits);
    pruned = select(all, kept);
    left = &pruned;
    result.nodes += pruning.nodes;
    result.work += pruning.work;
    limits.nodes -= std::min(limits.nodes, pruning.nodes);
    limits.work -= std::min(limits.work, pruning.work);
    if (!pruning.finished) bound = pruning.upper_bound;
    result.matches_after_pruning = kept.size();
  }
  (options.prune ? result.pruning_ms : result.search_ms) = clock.lap();
  const SearchResult search = search_poses(*left, best, limits);
  result.work += search.work;
  result.nodes += search.nodes;
  result.upper_bound = std::max(best.consensus, std::min(bound, search.upper_bound));
  if (best.consensus < options.at_least) {
    result.search_ms += clock.lap();
    return result;
  }
  result.consensus = best.consensus;
  result.certified = result.upper_bound == result.consensus;
  result.target_from_source = frame.pose(best.pose);
  for (const std::uint32_t i : inliers(all, best.pose)) result.inliers.push_back(all.original[i]);
  std::sort(result.inliers.begin(), result.inliers.end());
  result.search_ms += clock.lap();
  if (options.runner_up && search.finished) {
    limits.nodes -= std::min(limits.nodes, search.nodes);
    limits.work -= std::min(limits.work, search.work);
    seek_runner_up(all, best.pose, options, frame, limits, result);
  } else {
    result.runner_up_bound = result.upper_bound;
  }
  result.runner_up_ms = clock.lap();
  return result;
}

void find_runner_up(const Matches& matches, const MatchRegistrationOptions& options,
                    MatchRegistration* registration) {
  check(matches, options);
  if (matches.empty()) return;
  CpuClock clock;
  const Frame frame = frame_of(matches, options.up);
  seek_runner_up(levelled(matches, frame, options), frame.level_pose(registration->target_from_source),
                 options, frame, limits_of(options), *registration);
  registration->runner_up_ms += clock.lap();
}

}  // namespace scanlock
