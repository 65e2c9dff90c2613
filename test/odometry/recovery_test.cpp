// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/recovery.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "framed_tracker.hpp"
#include "geometry/angles.hpp"
#include "odometry/tracker.hpp"
#include "prepared_hall.hpp"
#include "room.hpp"

using namespace scanlock;

namespace {

std::int64_t utime(int i) {
  return 1000000 + 100000 * static_cast<std::int64_t>(i);
}

/// A sensor that drives at 1 m/s, is kidnapped to `there` at scan `kidnap`, and drives on from there.
struct KidnappedDrive {
  int kidnap;
  Pose there;
  int rays = 6000;
  Vector6 velocity = (Vector6() << 1, 0, 0, 0, 0, 0.1).finished();
  Pose pose(int i) const {
    return i < kidnap ? at(-8, 0, 0) * se3_exp(0.1 * i * velocity)
                      : there * se3_exp(0.1 * (i - kidnap) * velocity);
  }
  Scan scan(int i) const {
    return hall_scan(pose(i), velocity, utime(i), static_cast<unsigned>(i), 0.1, rays);
  }
};

/// Tracks a scan and answers a request of the tracker at once.
TrackedScan step(FramedTracker& tracker, PlaceFinder& finder, const Scan& scan, const ScanPrior& prior = {}) {
  const TrackedScan tracked = tracker.track(scan, prior);
  if (const auto request = tracker.take_request()) tracker.give(finder.find(*request));
  return tracked;
}

double error(const Pose& truth, const Pose& found) {
  return (truth.translation() - found.translation()).norm() +
         so3_log(truth.linear().transpose() * found.linear()).norm();
}

/// Parked cars on level ground, within 30 m of a sensor 1.5 m above it, axes and origin of the sensor.
PointCloud car_park(const Pose& map_from_sensor, unsigned seed) {
  std::mt19937 random(seed), layout(7);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud cloud;
  const auto add = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d seen = map_from_sensor.inverse() * p;
    if (seen.norm() < 30) cloud.push_back(seen.cast<float>().eval());
  };
  for (int i = 0; i < 8000; ++i) add({80 * unit(random) - 40, 80 * unit(random) - 40, -1.5});
  for (int car = 0; car < 40; ++car) {
    const Pose place =
        at(80 * unit(layout) - 40, 80 * unit(layout) - 40, std::floor(8 * unit(layout)) * 45 * kDegree);
    for (int i = 0; i < 500; ++i) {
      const double side = 12 * unit(random), high = 1.4 * unit(random) - 1.5;
      const Eigen::Vector3d p = side < 4    ? Eigen::Vector3d(side, 0, high)
                                : side < 8  ? Eigen::Vector3d(side - 4, 1.8, high)
                                : side < 10 ? Eigen::Vector3d(0, 0.9 * (side - 8), high)
                                            : Eigen::Vector3d(4, 0.9 * (side - 10), high);
      add(place * p);
    }
  }
  return cloud;
}

}  // namespace

TEST_CASE("searches with the same result add up to less than twice the odds of one, in any order") {
  CHECK(together({6}) == 6);
  CHECK(together({6, 6}) == doctest::Approx(8));
  CHECK(together({6, 6, 6}) == doctest::Approx(9));
  CHECK(together(std::vector<double>(20, 6)) < 12);
  CHECK(together({3, 6}) == together({6, 3}));
  CHECK(together({-4, 6}) == 4);
  CHECK(together({-2, -4}) == -4);
}

TEST_CASE("objects that are small for the scale of a search need a finer search") {
  RecoveryRequest request;
  request.target.places = {archived(Pose::Identity(), car_park(Pose::Identity(), 1))};
  request.target.source_radius = request.target.radius = 40;
  request.target.voxel = 1.0;
  request.tilt = 0.01;
  request.body_ups = {Eigen::Vector3d::UnitZ()};
  const Pose there = at(3, -2, 70 * kDegree);
  request.source = car_park(there, 2);
  CHECK(PlaceFinder().find(request).log_odds < kBelieved);
  request.finer = true;
  const RecoveryAnswer answer = PlaceFinder().find(request);
  CHECK(answer.log_odds > kBelieved);
  CHECK(error(there, answer.map_from_predicted) < 0.3);
}

TEST_CASE("a kidnapped robot is relocalised with a certificate and in the same frame") {
  const Frame frame = each_frame();
  const KidnappedDrive drive{60, at(-4, 1, 150 * kDegree)};
  FramedTracker tracker(TrackerConfig{}, frame);
  PlaceFinder finder;
  int accepted = 0, back = -1;
  for (int i = 0; i < 95; ++i) {
    const TrackedScan tracked = step(tracker, finder, drive.scan(i));
    const Pose truth = drive.pose(0).inverse() * drive.pose(i);
    if (i >= drive.kidnap && i < drive.kidnap + 2) CHECK(tracked.state != TrackingState::kTracking);
    if (tracked.state == TrackingState::kTracking) {
      CHECK(error(truth, tracked.map_from_body) < 0.1);
      if (i > drive.kidnap && back < 0) back = i;
    }
    if (!tracked.recovery) continue;
    if (!tracked.recovery->accepted) continue;
    CHECK(tracked.recovery->search.certified);
    CHECK(tracked.recovery->search.log_odds >= kBelieved);
    ++accepted;
    CHECK(tracked.method == PoseMethod::kGlobal);
    CHECK(tracked.recovery->epoch == 1);
    CHECK(tracked.recovery->search.consensus == tracked.recovery->search.upper_bound);
    CHECK(tracked.recovery->energy_after < tracked.recovery->energy_before);
  }
  CHECK(accepted == 1);
  CHECK(back > 0);
  CHECK(back <= drive.kidnap + 20);
}

TEST_CASE("keyframes of lost-mode odometry are part of the map after the relocalisation" *
          doctest::test_suite("long drives")) {
  const Frame frame = each_frame();
  const KidnappedDrive drive{60, at(7, 4, 170 * kDegree)};
  FramedTracker tracker(TrackerConfig{}, frame);
  PlaceFinder finder;
  bool back = false;
  int i = 0;
  for (; i < 100 && !back; ++i) {
    const TrackedScan tracked = tracker.track(drive.scan(i));
    back = tracked.recovery && tracked.recovery->accepted;
    // The robot drives 2 m before it is found.
    const auto request = i < 80 ? std::nullopt : tracker.take_request();
    if (request) tracker.give(finder.find(*request));
  }
  REQUIRE(back);
  int joined = 0;
  const SavedMap saved = tracker.save();
  for (const ArchivedKeyframe& k : saved.keyframes) {
    const int seen = static_cast<int>((k.utime - frame.later - utime(0)) / 100000);
    if (seen < drive.kidnap || seen + 1 >= i) continue;
    ++joined;
    const Pose found = frame.there_from_here.inverse() * k.map_from_body;
    CHECK(error(drive.pose(0).inverse() * drive.pose(seen), found) < 0.1);
  }
  CHECK(joined >= 2);
}

TEST_CASE("a sensor of few points is relocalised within two seconds") {
  const Frame frame = each_frame();
  for (const int rays : {300, 600}) {
    CAPTURE(rays);
    const KidnappedDrive drive{60, at(0, -1, 170 * kDegree), rays};
    FramedTracker tracker(TrackerConfig{}, frame);
    PlaceFinder finder;
    int back = -1;
    for (int i = 0; i < 80 && back < 0; ++i) {
      const TrackedScan tracked = step(tracker, finder, drive.scan(i));
      if (tracked.method != PoseMethod::kGlobal) continue;
      back = i;
      CHECK(error(drive.pose(0).inverse() * drive.pose(i), tracked.map_from_body) < 0.1);
    }
    CHECK(back > drive.kidnap);
  }
}

TEST_CASE("neither of two equal ends of a hall is accepted by chance" * doctest::test_suite("long drives")) {
  for (unsigned hall = 0; hall < 8; ++hall) {
    CAPTURE(hall);
    Tracker tracker(TrackerConfig{});
    PlaceFinder finder;
    int found = 0;
    for (int i = 0; i < 70; ++i) {
      const Pose pose = i < 40 ? at(-8 + 0.4 * i, 0, 0) : at(2, 3 - 0.05 * (i - 40), 2.5);
      const TrackedScan tracked =
          tracker.track(bare_hall_scan(pose, utime(i), 1000 * hall + static_cast<unsigned>(i)));
      CHECK_FALSE((tracked.recovery && tracked.recovery->accepted));
      const auto request = tracker.take_request();
      if (!request) continue;
      RecoveryAnswer answer = finder.find(*request);
      found += answer.verdict == PlaceVerdict::kFound;
      tracker.give(std::move(answer));
    }
    CHECK(found > 0);
  }
}

TEST_CASE("a search result is not tested while no fit of the scans could make it accepted" *
          doctest::test_suite("long drives")) {
  const Frame frame = each_frame();
  const KidnappedDrive drive{40, at(-5, -1, 100 * kDegree)};
  for (const bool one_will_do : {false, true}) {
    CAPTURE(one_will_do);
    FramedTracker tracker(TrackerConfig{}, frame);
    PlaceFinder finder;
    int answers = 0, back = -1;
    for (int i = 0; i < 70 && back < 0; ++i) {
      const TrackedScan tracked = tracker.track(drive.scan(i));
      if (i > drive.kidnap && tracked.state == TrackingState::kTracking) back = i;
      const auto request = i < 52 && answers > 0 ? std::nullopt : tracker.take_request();
      if (!request) continue;
      RecoveryAnswer answer = finder.find(*request);
      answer.log_odds = kBelieved - kInOwnMap - (one_will_do || answers > 0 ? 0 : 1.1 * kMostOfScans);
      answers += answer.verdict == PlaceVerdict::kFound;
      tracker.give(std::move(answer));
    }
    REQUIRE(back > 0);
    CHECK((answers == 1) == one_will_do);
    CHECK((back < 52) == one_will_do);
  }
}

TEST_CASE("a robot without points for 1.5 s tracks on at once, though half of its view is new ground") {
  const Frame frame = each_frame();
  const KidnappedDrive drive{1000, Pose::Identity()};
  FramedTracker tracker(TrackerConfig{}, frame);
  for (int i = 0; i < 54; ++i) {
    Scan scan = i < 25 ? half_of(drive.scan(i)) : drive.scan(i);
    const bool blind = i >= 25 && i < 40;
    if (blind) scan.points = {};
    const TrackedScan tracked = tracker.track(scan);
    CHECK(tracked.epoch == 0);
    if (i > 1) CHECK(tracked.state == (blind ? TrackingState::kDegraded : TrackingState::kTracking));
    CHECK(error(drive.pose(0).inverse() * drive.pose(i), tracked.map_from_body) < 0.05);
  }
}

TEST_CASE("a kidnapped robot that sees much new ground is relocalised, unless the odds are against the pose" *
          doctest::test_suite("long drives")) {
  const Frame frame = each_frame();
  const KidnappedDrive drive{25, at(0, -2, 100 * kDegree)};
  for (const bool against : {false, true}) {
    CAPTURE(against);
    FramedTracker tracker(TrackerConfig{}, frame);
    PlaceFinder finder;
    int back = -1;
    for (int i = 0; i < 45; ++i) {
      const TrackedScan tracked = tracker.track(i < drive.kidnap ? half_of(drive.scan(i)) : drive.scan(i));
      if (tracked.method == PoseMethod::kGlobal) back = i;
      if (back >= 0) CHECK(error(drive.pose(0).inverse() * drive.pose(i), tracked.map_from_body) < 0.05);
      const auto request = tracker.take_request();
      if (!request) continue;
      RecoveryAnswer answer = finder.find(*request);
      if (against) answer.log_odds = -1;
      tracker.give(std::move(answer));
    }
    CHECK((back > drive.kidnap) == !against);
  }
}

TEST_CASE("a planar sensor is relocalised by one search, unless that is evidence against the place") {
  const Frame frame = each_frame();
  const KidnappedDrive drive{60, at(-5, 1, 20 * kDegree)};
  for (const bool against : {false, true}) {
    CAPTURE(against);
    FramedTracker tracker(TrackerConfig{}, frame);
    PlaceFinder finder;
    int answers = 0;
    bool back = false;
    for (int i = 0; i < 80 && !back; ++i) {
      const TrackedScan tracked =
          tracker.track(planar_hall_scan(drive.pose(i), drive.velocity, utime(i), static_cast<unsigned>(i)));
      back = tracked.recovery && tracked.recovery->accepted;
      if (back) CHECK(error(drive.pose(0).inverse() * drive.pose(i), tracked.map_from_body) < 0.1);
      const auto request = answers == 0 || against ? tracker.take_request() : std::nullopt;
      if (!request) continue;
      RecoveryAnswer answer = finder.find(*request);
      ++answers;
      CHECK(answer.verdict == PlaceVerdict::kFound);
      CHECK(answer.certified);
      CHECK(answer.consensus == answer.upper_bound);
      if (against) answer.log_odds = -kMostOfScans;
      tracker.give(std::move(answer));
    }
    CHECK(back == !against);
    CHECK(answers > 0);
  }
}

TEST_CASE("in a foreign map a planar sensor finds no place that its scans believe in") {
  FramedTracker tracker(TrackerConfig{}, each_frame());
  PlaceFinder finder;
  const Vector6 velocity = (Vector6() << 1, 0, 0, 0, 0, 0.1).finished();
  for (int i = 0; i < 30; ++i)
    step(tracker, finder,
         planar_hall_scan(at(-8, 0, 0) * se3_exp(0.1 * i * velocity), velocity, utime(i),
                          static_cast<unsigned>(i)));
  // A narrower hall, of which every wall is elsewhere.
  const auto narrow = [&](int i) {
    Scan scan = planar_hall_scan(at(-3, 0, 1) * se3_exp(0.1 * i * velocity), velocity, utime(i),
                                 static_cast<unsigned>(i));
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      scan.points.x[k] *= 0.55f;
      scan.points.y[k] *= 0.55f;
    }
    return scan;
  };
  int searches = 0;
  for (int i = 30; i < 70; ++i) {
    const TrackedScan tracked = tracker.track(narrow(i));
    if (tracked.recovery) CHECK(!tracked.recovery->accepted);
    const auto request = tracker.take_request();
    if (!request) continue;
    ++searches;
    tracker.give(finder.find(*request));
  }
  CHECK(searches > 0);
}

TEST_CASE("the cache of earlier searches changes no answer" * doctest::test_suite("long drives")) {
  const Frame frame = each_frame();
  const KidnappedDrive drive{40, at(-5, -1, 100 * kDegree)};
  FramedTracker tracker(TrackerConfig{}, frame);
  std::optional<RecoveryRequest> request;
  for (int i = 0; i < 60 && !request; ++i) {
    tracker.track(drive.scan(i));
    request = tracker.take_request();
  }
  REQUIRE(request);
  RecoveryRequest elsewhere = *request, coarser = *request, turned = *request;
  elsewhere.target.centre += Eigen::Vector3d(5, 0, 0);
  coarser.target.voxel *= 1.35;
  // The same stamps in another map, as of a log that is played twice.
  for (ArchivedKeyframe& place : turned.target.places)
    place.map_from_body = at(1, 2, 0.5) * place.map_from_body;
  const std::vector<RecoveryRequest> requests{*request, elsewhere, coarser, turned};
  std::vector<RecoveryAnswer> fresh;
  for (const RecoveryRequest& asked : requests) fresh.push_back(PlaceFinder().find(asked));
  PlaceFinder remembering;
  for (const std::size_t asked : {0, 1, 2, 3, 0, 3, 1}) {
    const RecoveryAnswer answer = remembering.find(requests[asked]);
    CHECK(answer.map_from_predicted.matrix() == fresh[asked].map_from_predicted.matrix());
    CHECK(answer.matches == fresh[asked].matches);
    CHECK(answer.reason == fresh[asked].reason);
  }
}

TEST_CASE("a robot is relocalised in a map that another run saved") {
  const Frame frame = each_frame();
  const KidnappedDrive drive{1000, Pose::Identity()};
  FramedTracker first(TrackerConfig{}, frame);
  for (int i = 0; i < 60; ++i) first.track(drive.scan(i));
  FramedTracker second(TrackerConfig{}, frame);
  PlaceFinder finder;
  second.load(first.save());
  const KidnappedDrive later{0, at(-3, 1, 2.0)};
  TrackedScan tracked;
  for (int i = 0; i < 30; ++i) {
    tracked = step(second, finder, later.scan(i));
    if (tracked.state == TrackingState::kTracking) break;
    CHECK(tracked.method != PoseMethod::kIcp);
  }
  REQUIRE(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 2);  // one epoch for load(), one for the relocalisation
  CHECK(
      (tracked.map_from_body.translation() - (drive.pose(0).inverse() * at(-3, 1, 0)).translation()).norm() <
      4);
  for (int i = 30; i < 35; ++i) tracked = step(second, finder, later.scan(i));
  CHECK(error(drive.pose(0).inverse() * later.pose(34), tracked.map_from_body) < 0.1);
}

TEST_CASE("a robot that was carried onto a slope is relocalised, with an attitude sensor and without" *
          doctest::test_suite("long drives")) {
  const Frame frame = each_frame();
  const KidnappedDrive drive{
      40, at(-4, 0, -150 * kDegree) * se3_exp((Vector6() << 0, 0, 0, 10 * kDegree, 0, 0).finished())};
  FramedTracker with(TrackerConfig{}, frame), without(TrackerConfig{}, frame);
  PlaceFinder finder_with, finder_without;
  TrackedScan a, b;
  for (int i = 0; i < 60; ++i) {
    const Scan scan = drive.scan(i);
    ScanPrior prior;
    prior.level_from_body = Eigen::Quaterniond(drive.pose(i).linear());
    a = step(with, finder_with, scan, prior);
    b = step(without, finder_without, scan);
    if (i < drive.kidnap) continue;
    const Pose truth = drive.pose(0).inverse() * drive.pose(i);
    for (const TrackedScan* found : {&a, &b})
      if (found->state == TrackingState::kTracking) CHECK(error(truth, found->map_from_body) < 0.1);
  }
  for (const TrackedScan* found : {&a, &b}) {
    CHECK(found->state == TrackingState::kTracking);
    CHECK(found->epoch == 1);
  }
}

TEST_CASE("recoveries are the same in every run and for every number of threads" *
          doctest::test_suite("long drives")) {
  const Frame frame = each_frame();
  const KidnappedDrive drive{40, at(-5, -1, 100 * kDegree)};
  TrackerConfig one, two;
  two.threads = 2;
  FramedTracker a(one, frame), b(two, frame);
  PlaceFinder finder_a, finder_b;
  for (int i = 0; i < 60; ++i) {
    const TrackedScan x = step(a, finder_a, drive.scan(i)), y = step(b, finder_b, drive.scan(i));
    CHECK((x.map_from_body.matrix().array() == y.map_from_body.matrix().array()).all());
    CHECK(x.state == y.state);
    CHECK(x.recovery.has_value() == y.recovery.has_value());
  }
}

TEST_CASE("the answer to a search from before a reset is not used") {
  const Frame frame = each_frame();
  const KidnappedDrive drive{40, at(-5, -1, 100 * kDegree)};
  FramedTracker tracker(TrackerConfig{}, frame);
  PlaceFinder finder;
  std::optional<RecoveryRequest> request;
  int i = 0;
  for (; i < 70 && !request; ++i) {
    tracker.track(drive.scan(i));
    request = tracker.take_request();
  }
  REQUIRE(request);
  tracker.reset();
  tracker.give(finder.find(*request));
  const TrackedScan tracked = tracker.track(drive.scan(i));
  CHECK(tracked.state == TrackingState::kInitialising);
  CHECK_FALSE(tracked.recovery.has_value());
}

TEST_CASE("set_pose moves the robot within the same map") {
  const Frame frame = each_frame();
  const KidnappedDrive drive{1000, Pose::Identity()};
  FramedTracker tracker(TrackerConfig{}, frame);
  for (int i = 0; i < 60; ++i) tracker.track(drive.scan(i));
  const KidnappedDrive carried{0, drive.pose(20)};
  const Pose truth = drive.pose(0).inverse() * carried.pose(60);
  tracker.set_pose(at(0.2, -0.2, 0.05) * truth);
  TrackedScan tracked;
  for (int i = 60; i < 66; ++i) tracked = tracker.track(carried.scan(i));
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 1);
  CHECK(error(drive.pose(0).inverse() * carried.pose(65), tracked.map_from_body) < 0.1);
}

TEST_CASE("an odometry prior bridges a turn without points that a predicted velocity does not") {
  const Frame frame = each_frame();
  const KidnappedDrive before{1000, Pose::Identity()};
  FramedTracker with(TrackerConfig{}, frame), without(TrackerConfig{}, frame);
  for (int i = 0; i < 20; ++i) {
    with.track(before.scan(i));
    without.track(before.scan(i));
  }
  // Without points for a while, in which the robot turns round on the spot.
  Scan blind;
  blind.utime = utime(20);
  const Pose turned = before.pose(19) * at(0.3, 0, 170 * kDegree);
  ScanPrior prior;
  prior.motion = before.pose(19).inverse() * turned;
  const TrackedScan a = with.track(blind, prior), b = without.track(blind);
  const Pose truth = before.pose(0).inverse() * turned;
  CHECK(error(truth, a.map_from_body) < 0.1);
  CHECK(error(truth, b.map_from_body) > 1);
}
