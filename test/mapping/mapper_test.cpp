// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/mapper.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "../odometry/room.hpp"
#include "../trials.hpp"

namespace scanlock {
namespace {

Pose around(int scan) {
  Vector6 velocity;
  velocity << 3, 0, 0, 0, 0, 0.8;
  Pose start = Pose::Identity();
  start.translation() << 0, -3.75, 0;
  return start * se3_exp(0.1 * scan * velocity);
}

Scan seen(int scan) {
  Vector6 velocity;
  velocity << 3, 0, 0, 0, 0, 0.8;
  return hall_scan(around(scan), velocity, 1000000 + 100000 * static_cast<std::int64_t>(scan),
                   static_cast<unsigned>(scan), 0.1, 2000);
}

/// A small local map: after a lap of the hall it has forgotten the keyframes of the last visit.
TrackerConfig forgetful() {
  TrackerConfig config;
  config.max_keyframes = 8;
  config.max_map_points = 3000;
  config.max_source_points = 1200;
  return config;
}

/// The same scan in a hall with one of the long walls 3.5 m farther in.
Scan narrowed(Scan scan, const Pose& pose) {
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    Vector6 velocity;
    velocity << 3, 0, 0, 0, 0, 0.8;
    const Pose at = pose * se3_exp(static_cast<double>(scan.points.time[i]) * velocity);
    const double end = (at * scan.points.point(i).cast<double>()).y(), from = at.translation().y();
    const double part = end > 4.5 ? (4.5 - from) / (end - from) : 1.0;
    scan.points.x[i] *= static_cast<float>(part);
    scan.points.y[i] *= static_cast<float>(part);
    scan.points.z[i] *= static_cast<float>(part);
  }
  return scan;
}

/// A scan of a hall less than half as long, from the pose after `way` steps of a lap.
Scan elsewhere(int scan, int way) {
  Scan there =
      hall_scan(around(way), Vector6::Zero(), seen(scan).utime, static_cast<unsigned>(scan), 0.1, 2000);
  const Eigen::Matrix3f turn = around(way).linear().cast<float>();
  for (std::size_t i = 0; i < there.points.size(); ++i) {
    const Eigen::Vector3f p =
        turn.transpose() * Eigen::Vector3f(0.4F, 1, 1).cwiseProduct(turn * there.points.point(i));
    there.points.x[i] = p.x();
    there.points.y[i] = p.y();
    there.points.z[i] = p.z();
  }
  return there;
}

/// The number of keyframes of that scan and of later scans.
std::size_t since(const SavedMap& map, int scan) {
  return static_cast<std::size_t>(
      std::count_if(map.keyframes.begin(), map.keyframes.end(),
                    [&](const ArchivedKeyframe& k) { return k.utime >= seen(scan).utime; }));
}

void expect_same(const PoseGraph& graph, const std::vector<ArchivedKeyframe>& keyframes) {
  CHECK(graph.nodes().size() == keyframes.size() + 1);  // and the origin
  for (const ArchivedKeyframe& k : keyframes) {
    REQUIRE(graph.contains(k.id));
    CHECK(near(graph.nodes().at(k.id), k.map_from_body, 1e-6, 1e-6));
  }
}

}  // namespace

TEST_CASE("repeated laps keep the map consistent, and the variance below 4 times that of the first lap" *
          doctest::test_suite("long drives")) {
  int delay = 0;  // scans from a request to its answer
  if (all_trials()) {
    SUBCASE("requests answered at once") {}
  }
  SUBCASE("requests answered 25 scans later") {
    delay = 25;
  }
  Mapper mapper(forgetful());
  MapWorker worker(forgetful());
  std::optional<MapAnswer> answer;
  int due = 0;
  double once = 0, worst = 0;
  std::size_t first_round = 0;
  TrackedScan tracked;
  for (int i = 0; i < 1600; ++i) {
    tracked = mapper.track(seen(i));
    worst = std::max(
        worst,
        se3_log(around(0).inverse() * around(i)).norm() > 0
            ? se3_log((around(0).inverse() * around(i)).inverse() * tracked.map_from_body).head<3>().norm()
            : 0.0);
    if (auto request = mapper.take_request()) {
      CHECK_FALSE(mapper.take_request());  // one request at a time
      answer = worker.work(*request);
      due = i + delay;
    }
    if (answer && i >= due) mapper.give(*std::exchange(answer, std::nullopt));
    if (i == 75) first_round = mapper.save().keyframes.size();
    if (i == 100) once = tracked.covariance.topLeftCorner<3, 3>().trace();
  }
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 0);
  CHECK(tracked.loop_closures > 0);
  CHECK(worst < 0.05);
  CHECK(tracked.covariance.topLeftCorner<3, 3>().trace() < 4 * once);
  CHECK(near(tracked.map_from_body, tracked.local_from_body, 0.05, 0.01));
  const SavedMap saved = mapper.save();
  expect_same(mapper.graph(), saved.keyframes);
  CHECK(saved.keyframes.size() - since(saved, 75) == first_round);  // the keyframes of the first lap stay
  // Each minute brings new keyframes of all the ground; those of the last minute may be undecided.
  CHECK(saved.keyframes.size() < 2.5 * static_cast<double>(first_round));
}

TEST_CASE("where the surroundings have changed the newer keyframes are kept" *
          doctest::test_suite("long drives")) {
  Mapper mapper(forgetful());
  TrackedScan tracked;
  for (int i = 0; i < 900; ++i) {  // keyframes of the last minute are not compared with a later visit
    tracked = mapper.track(i < 100 ? seen(i) : narrowed(seen(i), around(i)));
    if (auto request = mapper.take_request()) mapper.give(MapWorker(forgetful()).work(*request));
  }
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(near(tracked.map_from_body, around(0).inverse() * around(899), 0.05, 0.01));
  const SavedMap saved = mapper.save();
  expect_same(mapper.graph(), saved.keyframes);
  CHECK(since(saved, 100) > 10);
  CHECK(since(saved, 0) - since(saved, 100) < 10);
}

TEST_CASE("a closure requested before a reset changes nothing after it") {
  Mapper mapper(forgetful());
  MapWorker worker(forgetful());
  std::optional<MapRequest> request;
  for (int i = 0; i < 900 && !request; ++i) {
    mapper.track(seen(i));
    request = mapper.take_request();
  }
  REQUIRE(request);
  ClosureAnswer accepted = std::get<ClosureAnswer>(worker.work(*request));
  mapper.reset();
  for (int i = 0; i < 30; ++i) mapper.track(seen(i));
  accepted.outcome = ClosureOutcome::kAccepted;  // as if the closure had been accepted
  accepted.nearest = 1;
  accepted.keyframe = 2;
  REQUIRE(mapper.graph().contains(2));
  const std::size_t constraints = mapper.graph().constraints().size();
  mapper.give(accepted);
  CHECK(mapper.graph().constraints().size() == constraints);
  CHECK(mapper.track(seen(30)).loop_closures == 0);
}

TEST_CASE("a loaded map has the constraints, loop closures and covariances of the saved map") {
  Mapper mapper(forgetful());
  int scans = 0;
  mapper.track(seen(scans++));
  while (mapper.graph().constraints().size() <= mapper.graph().nodes().size() && scans < 400) {
    mapper.track(seen(scans++));
    if (auto request = mapper.take_request()) mapper.give(MapWorker(forgetful()).work(*request));
  }
  const PoseGraph& before = mapper.graph();
  REQUIRE(before.constraints().size() > before.nodes().size());
  SavedMap saved = mapper.save();
  Mapper other(forgetful());
  other.load(saved);
  const PoseGraph& after = other.graph();
  REQUIRE(after.nodes().size() == before.nodes().size());
  REQUIRE(after.constraints().size() == before.constraints().size());
  const auto closures = [](const PoseGraph& graph) {
    return std::count_if(graph.constraints().begin(), graph.constraints().end(),
                         [](const Constraint& c) { return c.loop_closure; });
  };
  CHECK(closures(after) == closures(before));
  CHECK(closures(after) > 0);
  const Matrix6 last_before = before.covariance(kOriginNode, before.nodes().rbegin()->first);
  const Matrix6 last_after = after.covariance(kOriginNode, after.nodes().rbegin()->first);
  CHECK(last_after.isApprox(last_before, 1e-6));

  saved.constraints.resize(1);  // most keyframes have no constraint: their poses are taken as rigid
  other.load(saved);
  CHECK(other.graph().nodes().size() == before.nodes().size());
  CHECK(other.graph().parts().size() == 1);
  CHECK(other.other_submaps() == 0);
  const Matrix6 rigid = other.graph().covariance(kOriginNode, other.graph().nodes().rbegin()->first);
  CHECK(rigid.diagonal().maxCoeff() < 1e-2);
}

TEST_CASE("a fixed map is not changed, does not grow by revisits, and localises the robot in its frame" *
          doctest::test_suite("long drives")) {
  Mapper mapper(forgetful());
  for (int i = 0; i < 90; ++i) mapper.track(seen(i));  // a lap of the hall
  const SavedMap saved = mapper.save();
  const std::size_t known = saved.keyframes.size();
  Mapper other(forgetful());
  other.load(saved, true);
  CHECK(other.graph().nodes().empty());
  std::size_t most = 0;
  TrackedScan tracked;
  for (int i = 0; i < 700; ++i) {
    tracked = other.track(seen(i));
    if (auto request = other.take_request()) other.give(MapWorker(forgetful()).work(*request));
    if (i > 300) most = std::max(most, other.graph().nodes().size());
  }
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.loop_closures > 0);
  CHECK(near(tracked.map_from_body, around(0).inverse() * around(699), 0.05, 0.01));
  CHECK(most < known + 20);  // keyframes on known ground are dropped a reach behind the robot
  const SavedMap after = other.save();
  REQUIRE(after.keyframes.size() >= known);
  for (std::size_t k = 0; k < known; ++k)
    CHECK(near(after.keyframes[k].map_from_body, saved.keyframes[k].map_from_body, 1e-6, 1e-6));
}

TEST_CASE("a map that is saved and loaded each day grows only by new ground") {
  SavedMap map;
  std::size_t first = 0;
  for (int day = 0; day < 3; ++day) {
    Mapper mapper(TrackerConfig{});
    mapper.load(map);
    TrackedScan tracked;
    for (int i = 0; i < 90; ++i) {  // a lap of the hall
      tracked = mapper.track(seen(i));
      if (auto request = mapper.take_request()) mapper.give(MapWorker(TrackerConfig{}).work(*request));
    }
    CHECK(tracked.localised);
    CHECK(tracked.state == TrackingState::kTracking);
    map = mapper.save();
    if (day == 0) first = map.keyframes.size();
    CAPTURE(day);
    // Redundant keyframes within the last reach of each day's path are not dropped yet.
    CHECK(map.keyframes.size() <= first + static_cast<std::size_t>(6 * day));
  }
  CHECK(first > 12);
}

TEST_CASE("the first search targets of a loaded map are described before the first scan") {
  Mapper first(TrackerConfig{});
  for (int i = 0; i < 90; ++i) first.track(seen(i));  // a lap of the hall
  Mapper mapper(TrackerConfig{});
  MapWorker worker(TrackerConfig{}), unprepared(TrackerConfig{});
  mapper.load(first.save(), true);
  int ahead = 0;
  for (auto request = mapper.take_request(); request; request = mapper.take_request(), ++ahead) {
    REQUIRE(std::holds_alternative<SearchTarget>(*request));
    mapper.give(worker.work(*request));
  }
  CHECK(ahead == 2);  // one part, on two scales
  std::optional<MapRequest> request;
  for (int i = 0; i < 10 && !request; ++i) {
    mapper.track(seen(i));
    // A search with a single scan in motion would have another target.
    if (i > 3) request = mapper.take_request();
  }
  REQUIRE(request);
  REQUIRE(std::holds_alternative<RecoveryRequest>(*request));
  const auto answer = std::get<RecoveryAnswer>(worker.work(*request));
  const auto other = std::get<RecoveryAnswer>(unprepared.work(*request));
  CHECK(answer.verdict == PlaceVerdict::kFound);
  CHECK(answer.map_from_predicted.matrix() == other.map_from_predicted.matrix());
  CHECK(answer.cost_s < other.cost_s);
}

/// The outcome of a join for which the searches together have log odds of 3, and the prior another 3.
ClosureOutcome outcome_of_little(MapWorker& worker, JoinRequest request, std::size_t agreeing) {
  const double said = std::get<JoinAnswer>(worker.work(request)).search.log_odds;
  REQUIRE(said > 3);
  for (JoinResult& find : request.finds) find.log_odds = 2 * (3 - said) / static_cast<double>(agreeing);
  return std::get<JoinAnswer>(worker.work(request)).closure.outcome;
}

/// Adds other furniture before the same walls.
void furnish(std::vector<ArchivedKeyframe>* places) {
  for (ArchivedKeyframe& place : *places) {
    PointCloud points = *place.points.cloud();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::fmod(std::abs(points.x[i]) + std::abs(points.y[i]), 6.0f) > 2.0f) continue;
      points.x[i] *= 0.97f;
      points.y[i] *= 0.97f;
    }
    place.points = std::move(points);
  }
}

/// Whether both submaps were joined. Checks that they are not joined when the log odds of the agreeing finds
/// are very low; nor when these are only 3 and the robot was not found in the loaded map, or the furniture
/// differs.
bool doubted(MapWorker& worker, MapRequest request, const MapAnswer& answer) {
  const auto* join = std::get_if<JoinAnswer>(&answer);
  if (!join || join->closure.outcome != ClosureOutcome::kAccepted) return false;
  const auto little = [&](const JoinRequest& asked) {
    return outcome_of_little(worker, asked, join->agreeing.size());
  };
  JoinRequest other = std::get<JoinRequest>(request);
  CHECK_FALSE(other.active.located);
  CHECK(little(other) == ClosureOutcome::kPending);
  other.active.located = true;
  CHECK(little(other) == ClosureOutcome::kAccepted);
  furnish(&other.search.target.places);
  CHECK(little(other) == ClosureOutcome::kPending);
  for (JoinResult& find : std::get<JoinRequest>(request).finds) find.log_odds -= 100;
  CHECK(std::get<JoinAnswer>(worker.work(request)).closure.outcome == ClosureOutcome::kPending);
  return true;
}

TEST_CASE("a robot outside the given map tracks in a map of its own until it is found in the given map" *
          doctest::test_suite("long drives")) {
  TrackerConfig config = forgetful();
  config.new_map_after_s = 0.8;
  Mapper first(config);
  for (int i = 0; i < 90; ++i) first.track(seen(i));  // a lap of the hall
  const SavedMap saved = first.save();
  bool fixed = false, said = false;
  if (all_trials()) {
    SUBCASE("an extendable map, found by a search") {}
  }
  SUBCASE("a fixed map, found by a search") {
    fixed = true;
  }
  SUBCASE("a fixed map, found by set_pose") {
    fixed = said = true;
  }
  Mapper mapper(config);
  MapWorker worker(config);
  mapper.load(saved, fixed);
  int joins_doubted = 0;
  TrackedScan tracked;
  int i = 0;
  const auto follow = [&](int scans, const auto& scan) {
    for (const int end = i + scans; i < end; ++i) {
      tracked = mapper.track(scan(i));
      auto request = mapper.take_request();
      if (!request) continue;
      const MapAnswer answer = worker.work(*request);
      joins_doubted += doubted(worker, *request, answer) ? 1 : 0;
      mapper.give(answer);
    }
  };
  follow(15, [](int k) { return elsewhere(k, 0); });
  CHECK_FALSE(tracked.localised);
  // The robot has not moved: it is searched for where it stands.
  CHECK(tracked.state != TrackingState::kTracking);
  follow(60, [](int k) { return elsewhere(k, k - 15); });
  CHECK_FALSE(tracked.localised);
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(mapper.other_submaps() == 1);
  const std::uint32_t epoch = tracked.epoch;
  if (said) mapper.set_pose(around(0).inverse() * around(i));
  if (fixed && !said) {  // by a join: no search is answered in time
    for (const int end = i + 14; i < end; ++i) mapper.track(seen(i));
  }
  follow(said ? 10 : 60, seen);
  CHECK(tracked.localised);
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch > epoch);
  CHECK(near(tracked.map_from_body, around(0).inverse() * around(i - 1), 0.05, 0.01));
  CHECK((joins_doubted > 0) == (fixed && !said));  // otherwise by a search for a lost robot, or by set_pose()
}

TEST_CASE("a map whose up direction is not z keeps its up direction") {
  Mapper first(TrackerConfig{}), mapper(TrackerConfig{});
  for (int i = 0; i < 90; ++i) first.track(seen(i));  // a lap of the hall
  Vector6 lying;
  lying << 4, -2, 1, 0, 1.5, 0;
  const SavedMap given = moved(first.save(), se3_exp(lying));
  CHECK_FALSE(given.up.isApprox(Eigen::Vector3d::UnitZ(), 1e-3));
  mapper.load(given);
  const SavedMap kept = mapper.save();
  CHECK(kept.up.isApprox(given.up, 1e-9));
  REQUIRE(kept.keyframes.size() == given.keyframes.size());
  for (std::size_t k = 0; k < kept.keyframes.size(); ++k)
    CHECK(near(kept.keyframes[k].map_from_body, given.keyframes[k].map_from_body, 1e-6, 1e-6));
}

TEST_CASE("a robot in a submap that no constraint connects to the frame of the map file is not localised") {
  TrackerConfig config = forgetful();
  config.new_map_after_s = 0.8;
  Mapper first(config), there(config), later(config);
  MapWorker worker(config);
  for (int i = 0; i < 90; ++i) first.track(seen(i));  // a lap of the hall
  const auto follow = [&](Mapper& mapper, int begin) {
    TrackedScan tracked;
    for (int k = begin; k < begin + 50; ++k) {
      tracked = mapper.track(elsewhere(k, k - 15));
      if (auto request = mapper.take_request()) mapper.give(worker.work(*request));
    }
    CHECK(tracked.state == TrackingState::kTracking);
    CHECK_FALSE(tracked.localised);
  };
  there.load(first.save());
  follow(there, 15);
  REQUIRE(there.other_submaps() == 1);
  later.load(there.save());
  follow(later, 20);
  CHECK(later.other_submaps() == 1);
}

TEST_CASE("a robot that is lost on new ground tracks in a new submap, and in the first one when it returns" *
          doctest::test_suite("long drives")) {
  TrackerConfig config;
  config.new_map_after_s = 3;
  Mapper mapper(config);
  MapWorker worker(config);
  mapper.keep_history();
  int i = 0;
  TrackedScan tracked;
  const auto follow = [&](int scans, const auto& scan) {
    for (const int end = i + scans; i < end; ++i) {
      tracked = mapper.track(scan(i));
      if (auto request = mapper.take_request()) mapper.give(worker.work(*request));
    }
  };
  const auto hall = [](int k) {
    return hall_scan(at(-6, -1, 0.1), Vector6::Zero(), 100000 * k, static_cast<unsigned>(k));
  };
  const auto narrow = [](const Pose& pose, int k) {  // the hall less than half as long
    Scan scan = hall_scan(pose, Vector6::Zero(), 100000 * k, static_cast<unsigned>(k));
    const Eigen::Matrix3f turn = pose.linear().cast<float>();
    for (std::size_t p = 0; p < scan.points.size(); ++p) {
      Eigen::Vector3f point = turn * scan.points.point(p);
      point.x() *= 0.4F;
      point = turn.transpose() * point;
      scan.points.x[p] = point.x();
      scan.points.y[p] = point.y();
    }
    return scan;
  };
  follow(15, hall);
  const Pose first = tracked.map_from_body;
  follow(45, [&](int k) { return narrow(at(7, 5, 2.5), k); });
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 1);
  CHECK(mapper.other_submaps() == 1);
  const std::uint32_t stamp = tracked.stamp.value();

  follow(45, hall);
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 2);
  CHECK(mapper.other_submaps() == 1);
  CHECK(near(tracked.map_from_body, first, 0.03, 0.01));
  CHECK(near(mapper.correction(stamp), Pose::Identity(), 1e-9, 1e-9));
  const std::uint32_t node = mapper.graph().nodes().rbegin()->first;

  follow(45, [&](int k) { return narrow(at(7, 5, 2.5), k); });
  CHECK(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 3);  // the robot was found in the other submap
  CHECK_FALSE(mapper.graph().contains(node));
  CHECK(mapper.other_submaps() == 1);
}

TEST_CASE(
    "two submaps of the same ground are joined in the frame of the older, and saved as two before that" *
    doctest::test_suite("long drives")) {
  TrackerConfig config = forgetful();
  config.new_map_after_s = 1;
  Mapper mapper(config);
  MapWorker worker(config);
  mapper.keep_history();
  for (int i = 0; i < 90; ++i) mapper.track(seen(i));  // a lap of the hall
  const auto later = [](int i) {                       // kidnapped by a quarter of the lap
    Scan scan = seen(i + 20);
    scan.utime -= 2000000;
    return scan;
  };
  TrackedScan tracked, lost;
  int i = 90;
  for (; i < 130; ++i) {  // its requests are not answered
    tracked = mapper.track(later(i));
    mapper.take_request();
    if (i == 95) lost = tracked;
  }
  REQUIRE(tracked.state == TrackingState::kTracking);
  CHECK(tracked.epoch == 1);
  REQUIRE(mapper.other_submaps() == 1);
  const std::uint32_t stamp = tracked.stamp.value();
  const Pose told = tracked.map_from_body, truth = around(0).inverse() * around(129 + 20);
  CHECK((told.translation() - truth.translation()).norm() > 1);

  const SavedMap saved = mapper.save();
  Mapper other(config);
  other.load(saved);
  CHECK(other.other_submaps() == 1);
  CHECK(other.save().constraints.size() == saved.constraints.size());
  for (const ArchivedKeyframe& k : other.save().keyframes) CHECK(k.map_from_body.translation().norm() < 20);
  const std::size_t first = first_submap(saved).keyframes.size();
  CHECK(first == submaps_of(saved).front().graph.nodes().size() - 1);
  CHECK(first < saved.keyframes.size());
  other.load(saved, true);
  CHECK(other.save().keyframes.size() == first);

  mapper.give(RecoveryAnswer());  // a late answer
  for (; i < 300 && mapper.other_submaps() > 0; ++i) {
    tracked = mapper.track(later(i));
    if (auto request = mapper.take_request()) mapper.give(worker.work(*request));
  }
  CHECK(mapper.other_submaps() == 0);
  tracked = mapper.track(later(i));
  REQUIRE(tracked.recovery);
  CHECK(tracked.recovery->accepted);
  CHECK(tracked.recovery->search.certified);
  CHECK(tracked.epoch == 2);
  CHECK(near(tracked.map_from_body, around(0).inverse() * around(i + 20), 0.05, 0.01));
  CHECK(near(mapper.correction(stamp) * told, truth, 0.05, 0.01));
  CHECK(lost.state == TrackingState::kRecovering);
  CHECK(near(mapper.correction(lost.stamp.value()) * lost.map_from_body,
             around(0).inverse() * around(95 + 20), 0.05, 0.01));
  expect_same(mapper.graph(), mapper.save().keyframes);
}

TEST_CASE("a saved map is loaded as one graph, and a reset empties the graph") {
  Mapper mapper(forgetful());
  for (int i = 0; i < 40; ++i) mapper.track(seen(i));
  const SavedMap saved = mapper.save();
  Mapper other(forgetful());
  other.load(saved);
  other.track(seen(40));
  CHECK(other.graph().nodes().size() == saved.keyframes.size() + 1);
  CHECK(other.graph().constraints().size() == saved.keyframes.size());
  other.reset();
  CHECK(other.graph().nodes().empty());
  other.track(seen(0));
  other.track(seen(1));
  CHECK(other.graph().nodes().size() == 2);
}

}  // namespace scanlock
