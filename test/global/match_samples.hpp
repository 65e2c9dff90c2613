// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "geometry/match.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// The angle between the rotations of two poses, radians.
inline double angle_between(const Pose& a, const Pose& b) {
  return so3_log(a.linear().transpose() * b.linear()).norm();
}

/// Random match sets about a planted pose.
class MatchSampler {
 public:
  explicit MatchSampler(unsigned seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  Eigen::Vector3d point(double half_side) {
    return {uniform(-half_side, half_side), uniform(-half_side, half_side), uniform(-half_side, half_side)};
  }
  Eigen::Vector3d direction() {
    Eigen::Vector3d d;
    do {
      d = point(1);
    } while (d.norm() > 1 || d.norm() < 0.1);
    return d.normalized();
  }
  Eigen::Isometry3d pose(double half_side) {
    Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
    t.linear() =
        Eigen::AngleAxisd(uniform(0, 6.283185307179586), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    t.translation() = point(half_side);
    return t;
  }
  /// `noise`: the largest length of an inlier's residual, metres; with `exactly` the length of all of them.
  Matches matches(int count, int inliers, const Eigen::Isometry3d& truth, double half_side, double noise,
                  bool exactly = false) {
    Matches result;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p = point(half_side);
      const double length = exactly ? noise : uniform(0, noise);
      result.push_back(
          {p, i < inliers ? Eigen::Vector3d(truth * p + length * direction()) : point(half_side)});
    }
    std::shuffle(result.begin(), result.end(), random_);
    return result;
  }
  void shuffle(Matches& matches) { std::shuffle(matches.begin(), matches.end(), random_); }

 private:
  std::mt19937 random_;
};

}  // namespace scanlock
