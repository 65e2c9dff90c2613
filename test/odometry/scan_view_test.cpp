// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_view.hpp"

#include <doctest/doctest.h>

#include <random>

#include "room.hpp"

using namespace scanlock;

namespace {

PointCloud seen_from(const Pose& pose, unsigned seed) {
  return hall_scan(pose, Vector6::Zero(), 0, seed).points;
}

double contradicted_share(const PointCloud& here, const PointCloud& there, const Pose& here_from_there) {
  return ScanView(here).contradicted_share(there, here_from_there, ScanView(there));
}

}  // namespace

TEST_CASE("points that columns hide or reveal between two poses are no contradiction") {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (unsigned k = 0; k < 40; ++k) {
    const auto place = [&] {
      Pose pose = se3_exp(yaw(3 * uniform(rng)));
      pose.translation() << 3 * uniform(rng), uniform(rng), 0;  // between the columns
      return pose;
    };
    const Pose a = place(), b = place();
    CAPTURE((a.translation() - b.translation()).norm());
    CHECK(contradicted_share(seen_from(a, 2 * k), seen_from(b, 2 * k + 1), a.inverse() * b) < 0.01);
  }
}

TEST_CASE("a wall in the free space of the other scan contradicts, in both directions") {
  const Pose here = Pose::Identity();
  const PointCloud open = seen_from(here, 1);
  PointCloud closed = seen_from(here, 2);
  double walled = 0;  // share of the points
  for (std::size_t i = 0; i < closed.size(); ++i) {
    if (closed.x[i] < 3) continue;
    const float nearer = 3 / closed.x[i];
    closed.x[i] *= nearer;
    closed.y[i] *= nearer;
    closed.z[i] *= nearer;
    walled += 1.0 / static_cast<double>(closed.size());
  }
  REQUIRE(walled > 0.2);
  CHECK(contradicted_share(open, closed, here) == doctest::Approx(walled).epsilon(0.2));
  CHECK(contradicted_share(closed, open, here) == doctest::Approx(walled).epsilon(0.2));
}

TEST_CASE("points outside the view of the other scan are no contradiction") {
  const Pose here = Pose::Identity();
  const PointCloud all = seen_from(here, 1);
  const PointCloud part = half_of(hall_scan(here, Vector6::Zero(), 0, 2)).points;
  CHECK(contradicted_share(all, part, here) < 0.01);
  CHECK(contradicted_share(part, all, here) < 0.01);
  CHECK(contradicted_share({}, all, here) == 0);
  CHECK(contradicted_share(all, {}, here) == 0);
  CHECK(ScanView().contradicted_share(all, here, ScanView(all)) == 0);
}

TEST_CASE("a scan of another pose in the same hall contradicts") {
  Pose elsewhere = Pose::Identity();
  elsewhere.translation() << -6, 5, 0;
  CHECK(contradicted_share(seen_from(Pose::Identity(), 1), seen_from(elsewhere, 2), Pose::Identity()) > 0.3);
}
