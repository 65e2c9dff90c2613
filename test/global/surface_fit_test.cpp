// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/surface_fit.hpp"

#include <doctest/doctest.h>

#include <random>

#include "geometry/rigid_fit.hpp"
#include "global/hypothesis.hpp"
#include "scenes.hpp"

using namespace scanlock;

namespace {

/// Random numbers that are the same on every machine.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : rng_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(rng_()) / 4294967295.0;
  }

 private:
  std::mt19937 rng_;
};

/// Three walls about the sensor. Each point of a wall is matched to a point up to a metre away on the same
/// wall, more often to one side than to the other.
std::vector<SurfaceMatch> matches_of_walls(const Pose& truth) {
  Numbers number(3);
  std::vector<SurfaceMatch> matches;
  for (const double bearing : {0.0, 1.5, 2.2}) {
    const Eigen::Vector3d normal(std::cos(bearing), std::sin(bearing), 0);
    const Eigen::Vector3d side(-normal.y(), normal.x(), 0), up(0, 0, 1);
    for (int k = 0; k < 300; ++k) {
      const Eigen::Vector3d q = 8 * normal + number(-6, 6) * side + number(0, 4) * up;
      const Eigen::Vector3d seen =
          q + number(-0.4, 1) * side + number(-1, 1) * up + number(-0.02, 0.02) * normal;
      matches.push_back({truth.inverse() * seen, q, truth.linear().transpose() * normal, -normal});
    }
  }
  return matches;
}

Pose fit_of_points(const std::vector<SurfaceMatch>& matches) {
  PairSums sums;
  for (const SurfaceMatch& m : matches) sums.add(1, m.p, m.q);
  return level_fit(sums);
}

}  // namespace

TEST_CASE("matches that are shifted along walls give the pose at which the walls coincide") {
  const Pose truth = level_pose(0.8, 1, -2, 0.3);
  const std::vector<SurfaceMatch> matches = matches_of_walls(truth);
  const Eigen::Vector3d centre(1, 2, 1);
  CHECK_FALSE(near(fit_of_points(matches), truth, 0.1, 0.01));  // a fit of the points alone is biased
  const Pose start = level_pose(0.8 + 0.02, 1.3, -2.2, 0.3);
  const Pose found = fit_surfaces(matches, start, centre, 0.3);
  CHECK((found.translation() - truth.translation()).head<2>().norm() < 0.02);
  CHECK(near(found, truth, 0.2, 0.002));
  CHECK(found.linear().col(2).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST_CASE("with normals of all bearings the whole pose is found, also its height") {
  const Pose truth = level_pose(-1, 3, 1, -0.2);
  Numbers number(5);
  std::vector<SurfaceMatch> matches;
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d q(number(-9, 9), number(-9, 9), number(0, 3));
    const Eigen::Vector3d noise(number(-0.1, 0.1), number(-0.1, 0.1), number(-0.1, 0.1));
    const double bearing = number(-3, 3);
    const Eigen::Vector3d normal(std::cos(bearing), std::sin(bearing), 0);  // vertical surfaces only
    matches.push_back({truth.inverse() * (q + noise), q, truth.linear().transpose() * normal, normal});
  }
  const Pose found = fit_surfaces(matches, level_pose(-0.98, 3.1, 0.9, 0.1), Eigen::Vector3d::Zero(), 0.3);
  CHECK(near(found, truth, 0.03, 0.002));  // the height is found, too
}

TEST_CASE("the axis of the target is kept, and too few matches leave the pose unchanged") {
  Pose tip = Pose::Identity();
  tip.linear() = so3_exp(Eigen::Vector3d(0.2, -0.1, 0));
  const Pose level_truth = level_pose(0.8, 1, -2, 0.3);
  std::vector<SurfaceMatch> matches = matches_of_walls(level_truth);
  for (SurfaceMatch& m : matches) {
    m.q = tip * m.q;
    m.normal_q = tip.linear() * m.normal_q;
  }
  const Pose start = tip * level_pose(0.78, 1.2, -2.2, 0.3);
  const Pose found = fit_surfaces(matches, start, Eigen::Vector3d::Zero(), 0.3);
  CHECK(near(found, tip * level_truth, 0.2, 0.002));
  CHECK(found.linear().col(2).isApprox(tip.linear().col(2)));
  matches.resize(7);
  CHECK(fit_surfaces(matches, start, Eigen::Vector3d::Zero(), 0.3).matrix() == start.matrix());
  CHECK(fit_surfaces({}, start, Eigen::Vector3d::Zero(), 0.3).matrix() == start.matrix());
}
