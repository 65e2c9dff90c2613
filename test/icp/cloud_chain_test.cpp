// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_chain.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "cloud_samples.hpp"

using namespace scanlock;
using namespace scanlock::test;

TEST_CASE("a chain composes the motions of its links") {
  // The second step is too far from the identity as its guess: the chain has to extrapolate the motion.
  CloudChain chain(*find_cloud_method("robust-icp-plane"), {}, 0.0);
  for (int i = 0; i < 5; ++i) {
    Random random(static_cast<unsigned>(i));
    const Pose truth = motion({0.25 * i, -0.1 * i, 0}, {0, 0, 0.06 * i});
    const auto link = chain.add(moved(room(random, 4000, 0.003), truth.inverse()));
    CHECK(link.has_value() == (i > 0));
    const Pose error = chain.poses().back().inverse() * truth;
    CAPTURE(i);
    CHECK(error.translation().norm() < 0.01);
    CHECK(so3_log(error.linear()).norm() < 0.003);
  }
}

TEST_CASE("a cloud that cannot be used leaves the chain as it was") {
  Random random(9);
  CloudChain chain(*find_cloud_method("robust-icp"), {}, std::nullopt);
  const PointCloud good = room(random, 3000);
  CHECK_FALSE(chain.add(good).has_value());
  CHECK_THROWS_AS(chain.add(PointCloud{}), std::invalid_argument);
  CHECK(chain.poses().size() == 1);
  const auto link = chain.add(moved(good, motion({-0.1, 0, 0}, {0, 0, 0})));
  REQUIRE(link.has_value());
  CHECK(link->target_from_source.translation().x() == doctest::Approx(0.1).epsilon(0.01));
}
