// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/hypothesis_test.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "prepared_hall.hpp"

using namespace scanlock;

namespace {

const Pose kThere(Eigen::Translation3d(40, 0, 0));

struct Ending {
  HypothesisTest::Outcome outcome;
  Pose place;
  std::string why_undecided;
  double log_odds;
};

/// The outcome of a test in a map, for a sensor at rest in the hall, all of which it sees.
Ending ending_of(HypothesisTest test, const std::vector<ArchivedKeyframe>& map,
                 const std::optional<Pose>& uncontradicted = std::nullopt) {
  const TrackerConfig config;
  PreparedHall hall(config);
  const PreparedScan first = hall.scan(0);
  Odometer odometer(config);
  odometer.start(0, first, {});
  odometer.reload(map, {20, 0, 0}, first.voxel);
  LostModeOdometry lost_odometry(config, 0, first, {});
  if (uncontradicted) test.note_uncontradicted(*uncontradicted, lost_odometry);
  HypothesisTest::Outcome outcome = HypothesisTest::Outcome::kOpen;
  for (unsigned i = 1; outcome == HypothesisTest::Outcome::kOpen; ++i) {
    const PreparedScan next = hall.scan(i);
    lost_odometry.follow(100000 * i, 0.1, next);
    outcome = test.judge(odometer, next, lost_odometry);
  }
  return {outcome, test.map_from_predicted(), test.why_undecided(), test.log_odds()};
}

Ending test_of(const std::vector<ArchivedKeyframe>& map, const std::vector<Pose>& places,
               bool uncontradicted) {
  return ending_of(HypothesisTest(places), map, uncontradicted ? std::optional(places.back()) : std::nullopt);
}

/// The outcome of a test between the hall, which the map shows as a whole, and an equal hall 40 m away, of
/// which the map shows one half.
Ending between_twins(bool uncontradicted) {
  Scan map;
  map.points = hall_map();
  return test_of({archived(Pose::Identity(), map.points), archived(kThere, half_of(map).points)},
                 {Pose::Identity(), kThere}, uncontradicted);
}

}  // namespace

TEST_CASE("a partly mapped twin does not block a hypothesis, unless a search found no contradiction to it") {
  CHECK(between_twins(false).outcome == HypothesisTest::Outcome::kWon);
  const Ending open = between_twins(true);
  CHECK(open.outcome == HypothesisTest::Outcome::kUndecided);
  CHECK(open.why_undecided == "the scans after the search fit several hypotheses equally well");
}

TEST_CASE("a preferred hypothesis does not win because the map of a better hypothesis is incomplete") {
  Scan map;
  map.points = hall_map();
  const PointCloud most = covered(map, [](float x, float y, float) { return x < 3 || y < 0; }).points;
  const Ending ending = test_of({archived(Pose::Identity(), most), archived(kThere, half_of(map).points)},
                                {kThere, Pose::Identity()}, false);
  CHECK(ending.outcome == HypothesisTest::Outcome::kUndecided);
  CHECK(near(ending.place, Pose::Identity(), 0.1, 0.1));
}

TEST_CASE("a hypothesis that a search leaves alone wins, but not at the wrong place") {
  const std::vector<ArchivedKeyframe> map = {archived(Pose::Identity(), hall_map()),
                                             archived(kThere, hall_map())};
  const Pose wrong(Eigen::Translation3d(0, 0, 6));
  for (const Pose& kept : {Pose::Identity(), kThere, wrong}) {
    HypothesisTest test({Pose::Identity(), kThere, wrong});
    test.keep_only(kept, Pose::Identity());
    REQUIRE(test.hypotheses().size() == 1);
    const Ending ending = ending_of(std::move(test), map);
    CHECK((ending.outcome == HypothesisTest::Outcome::kWon) == (kept.translation() != wrong.translation()));
  }
  HypothesisTest unknown({Pose::Identity(), kThere});
  unknown.keep_only(wrong, Pose::Identity());
  CHECK(unknown.hypotheses().size() == 2);
}

TEST_CASE("at the expected pose, without a search, the inlier ratio has to be as usual") {
  Scan map;
  map.points = hall_map();
  const auto ending = [](const PointCloud& points) {
    return ending_of(HypothesisTest::expected_at(Pose::Identity(), 0), {archived(Pose::Identity(), points)});
  };
  CHECK(ending(map.points).outcome == HypothesisTest::Outcome::kWon);
  CHECK(ending(half_of(map).points).outcome == HypothesisTest::Outcome::kRefuted);
}

TEST_CASE(
    "hypotheses that look alike are decided only by large differences of the points that they explain") {
  Scan map;
  map.points = hall_map();
  const auto against = [&](const PointCloud& twin) {
    return test_of({archived(Pose::Identity(), map.points), archived(kThere, twin)},
                   {kThere, Pose::Identity()}, false);
  };
  const Ending alike = against(map.points);
  CHECK(alike.outcome == HypothesisTest::Outcome::kUndecided);
  CHECK(alike.why_undecided == "the scans after the search fit several hypotheses equally well");
  PointCloud one = map.points, many = map.points;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const Eigen::Vector3f p = map.points.point(i);
    if (p.y() > 7.9f && p.x() > 0 && p.x() < 3) one.y[i] += 0.3f;  // a cupboard
    if (p.y() > 7.9f) many.y[i] += 0.3f;                           // two walls
    if (p.x() > 11.9f) many.x[i] += 0.3f;
  }
  CHECK(against(one).outcome == HypothesisTest::Outcome::kUndecided);
  CHECK(against(many).outcome == HypothesisTest::Outcome::kWon);
}

TEST_CASE("points off the surfaces of a map count against its hypothesis, and unmapped points do not count") {
  const PointCloud all = hall_map();
  PointCloud part;  // a sixth of the hall is not mapped
  PointCloud other = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::Vector3f p = all.point(i);
    if (p.y() > -7.9f && p.x() > -11.9f) part.push_back(p);
    const auto cupboard = [](float along) { return std::fmod(std::abs(along), 6.0f) < 3.0f; };
    if (p.y() > 7.9f && cupboard(p.x())) other.y[i] -= 0.4f;
    if (p.y() < -7.9f && cupboard(p.x())) other.y[i] += 0.4f;
    if (p.x() > 11.9f && cupboard(p.y())) other.x[i] -= 0.4f;
  }
  const Ending ending =
      test_of({archived(Pose::Identity(), part), archived(kThere, other)}, {Pose::Identity(), kThere}, false);
  CHECK(ending.outcome == HypothesisTest::Outcome::kWon);
  CHECK(near(ending.place, Pose::Identity(), 0.1, 0.01));
}

TEST_CASE("points on mapped surfaces raise the odds of a hypothesis, and points off them lower the odds") {
  const PointCloud all = hall_map();
  PointCloud part, moved = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::Vector3f p = all.point(i);
    if (p.y() < 7.9f) part.push_back(p);
    if (p.y() > 7.9f) moved.y[i] += 0.3f;
    if (p.x() > 11.9f) moved.x[i] += 0.3f;
  }
  const auto said = [&](const PointCloud& map) {
    return test_of({archived(Pose::Identity(), map)}, {Pose::Identity()}, false).log_odds;
  };
  const double whole = said(all), shown_in_part = said(part);
  CHECK(whole > 3);
  CHECK(shown_in_part > 0);
  CHECK(shown_in_part < whole);
  CHECK(said(moved) < -5);
}

TEST_CASE("a hypothesis does not win for a percent more points where two walls are 0.05 m off") {
  Scan map;
  map.points = hall_map();
  PointCloud twin = map.points;
  for (float& x : twin.x) x += x > 11.9f ? 0.05f : 0.0f;
  for (float& y : twin.y) y += y > 7.9f ? 0.05f : 0.0f;
  const Ending ending = test_of({archived(Pose::Identity(), map.points), archived(kThere, twin)},
                                {kThere, Pose::Identity()}, false);
  CHECK(ending.outcome == HypothesisTest::Outcome::kUndecided);
}

TEST_CASE("a hypothesis of a search may fit less well than the scans fit each other, as on another day") {
  const TrackerConfig config;
  PreparedHall hall(config);
  PointCloud map = hall_map();
  for (float& x : map.x) x += x > 11.9f ? 0.2f : 0.0f;  // one wall 0.2 m farther off, and then another wall
  for (float& y : map.y) y += y > 7.9f ? 0.2f : 0.0f;
  const PreparedScan first = hall.scan(0);
  Odometer odometer(config);
  odometer.reload({archived(Pose::Identity(), map)}, Eigen::Vector3d::Zero(), first.voxel);
  LostModeOdometry lost_odometry(config, 0, first, {});
  HypothesisTest test({Pose::Identity()});
  HypothesisTest::Outcome outcome = HypothesisTest::Outcome::kOpen;
  for (unsigned i = 1; i < 6; ++i) lost_odometry.follow(100000 * i, 0.1, hall.scan(i));
  for (unsigned i = 6; outcome == HypothesisTest::Outcome::kOpen; ++i) {
    const PreparedScan next = hall.scan(i);
    lost_odometry.follow(100000 * i, 0.1, next);
    outcome = test.judge(odometer, next, lost_odometry);
  }
  CHECK(outcome == HypothesisTest::Outcome::kWon);
}
