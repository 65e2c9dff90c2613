// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/level_frame.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "geometry/elementary.hpp"

namespace scanlock {

void check_input(const Matches& matches, const MatchRegistrationOptions& options) {
  const auto require = [](bool good, const char* sentence) {
    if (!good) throw std::invalid_argument(sentence);
  };
  require(options.epsilon > 0 && std::isfinite(options.epsilon),
          "epsilon must be a number of metres above 0");
  require(options.up.allFinite() && options.up.norm() > 0,
          "the up axis must be a finite vector other than 0");
  require(options.tilt >= 0 && options.tilt <= 0.5, "the tilt must be between 0 and 0.5 radians");
  require(options.budget_s >= 0, "the budget must be 0 seconds or more");
  require(options.runner_up_distance >= 0 && options.runner_up_angle >= 0,
          "the distance and angle of the runner-up must be 0 or more");
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

LevelFrame::LevelFrame(const Matches& matches, const Eigen::Vector3d& up) {
  const Eigen::Vector3d axis = up.normalized();
  if (axis != Eigen::Vector3d::UnitZ()) level = level_rotation(axis);
  for (const Match& match : matches) {
    p_centre += match.p;
    q_centre += match.q;
  }
  const double n = static_cast<double>(std::max<std::size_t>(matches.size(), 1));
  p_centre /= n;
  q_centre /= n;
}

Pose LevelFrame::pose(const LevelPose& found) const {
  Pose result = Pose::Identity();
  result.linear() = level.transpose() * rotation_about_z(found.theta) * level;
  result.translation() =
      q_centre + level.transpose() * Eigen::Vector3d(found.x, found.y, found.z) - result.linear() * p_centre;
  return result;
}

LevelPose LevelFrame::level_pose(const Pose& pose) const {
  const Eigen::Matrix3d turn = level * pose.linear() * level.transpose();
  const Eigen::Vector3d way = level * (pose.translation() + pose.linear() * p_centre - q_centre);
  return {atan2(turn(1, 0), turn(0, 0)), way.x(), way.y(), way.z()};
}

LevelMatches LevelFrame::levelled(const Matches& matches, const MatchRegistrationOptions& options) const {
  LevelMatches result;
  result.reserve(matches.size());
  const double tilt = 4 * sin(0.5 * options.tilt);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Vector3d p = level * (matches[i].p - p_centre);
    const Eigen::Vector3d q = level * (matches[i].q - q_centre);
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

}  // namespace scanlock
