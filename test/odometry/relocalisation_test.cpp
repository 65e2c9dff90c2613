// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/relocalisation.hpp"

#include <doctest/doctest.h>

#include <string>

#include "prepared_hall.hpp"

using namespace scanlock;

namespace {

/// A robot at rest that was kidnapped, and the answers of a search: its true pose, or a runner-up.
struct Displaced {
  explicit Displaced(const TrackerConfig& config)
      : hall(config), first(hall.scan(0)), odometer(config), relocalisation(config) {
    odometer.start(0, first, {});
  }

  /// `rough`: metres by which points lie off their surfaces, on both sides. `whole`: false leaves out one
  /// corner.
  void remember(const std::vector<Pose>& halls, float rough = 0, bool whole = true) {
    PointCloud map;
    const PointCloud full = hall_map();
    for (std::size_t i = 0; i < full.size(); ++i)
      if (whole || full.x[i] < 0 || full.y[i] < 0) map.push_back(full.x[i], full.y[i], full.z[i]);
    for (std::size_t i = 0; i < map.size(); ++i)
      for (auto* coordinates : {&map.x, &map.y, &map.z}) (*coordinates)[i] += i % 2 == 0 ? rough : -rough;
    std::vector<ArchivedKeyframe> places;
    for (float x : {-1.0f, -0.5f, 0.0f, 0.5f}) {
      PointCloud seen = map;
      for (float& px : seen.x) px -= x;
      for (const Pose& at : halls) places.push_back(archived(at * Pose(Eigen::Translation3d(x, 0, 0)), seen));
    }
    archive.restore(places);
  }

  void lose() {
    odometer.set_pose(lost);
    relocalisation.distrust(0, 0, first, odometer, 1);
    relocalisation.begin(odometer, std::nullopt, false, archive);
  }

  /// Loses the robot in the map of the halls, loaded around the true pose.
  void lose_in(const std::vector<Pose>& halls, float rough = 0, bool whole = true) {
    remember(halls, rough, whole);
    odometer.reload(archive.keyframes(), Eigen::Vector3d::Zero(), first.voxel);
    lose();
  }

  /// Answers a request by a search that found `place`. False: there was no request.
  bool propose(unsigned i, const std::vector<Pose>& runners_up, double log_odds = kBelieved,
               double voxel = 0.1, const Pose& place = Pose::Identity()) {
    const auto request = relocalisation.take_request(100000 * i, archive, std::nullopt);
    if (!request) return false;
    RecoveryAnswer answer;
    answer.serial = request->serial;
    answer.utime = request->utime;
    answer.verdict = PlaceVerdict::kFound;
    answer.log_odds = log_odds;
    answer.voxel = voxel;
    answer.certified = true;
    answer.no_rival = no_rival;
    answer.map_from_predicted = place * lost.inverse();
    for (const Pose& runner_up : runners_up) answer.runners_up.push_back(runner_up * lost.inverse());
    relocalisation.give(answer, archive, first.voxel, odometer);
    return true;
  }

  /// Follows scans until a hypothesis is accepted, or for four seconds.
  Relocalisation::Outcome follow(const Pose& runner_up) {
    auto outcome = Relocalisation::Outcome::kLost;
    bool proposed = false;
    Attempt attempt;
    for (unsigned i = 1; i < 40 && outcome == Relocalisation::Outcome::kLost; ++i) {
      outcome = relocalisation.follow(100000 * i, 0.1, hall.scan(i), odometer, &attempt);
      if (!proposed) proposed = propose(i, {runner_up});
    }
    REQUIRE(proposed);
    return outcome;
  }

  PreparedHall hall;
  PreparedScan first;
  Odometer odometer;
  Relocalisation relocalisation;
  KeyframeArchive archive{10000000};
  Pose lost{Eigen::Translation3d(20, 60, 0)};
  bool no_rival = false;  ///< whether searches exclude all other places
};

}  // namespace

TEST_CASE("a hypothesis is not accepted while an equal one outside the local map remains") {
  TrackerConfig config;
  config.max_keyframes = 4;
  const Pose twin(Eigen::Translation3d(40, 0, 0));
  Displaced robot(config);
  robot.lose_in({Pose::Identity(), twin});
  CHECK(robot.follow(twin) == Relocalisation::Outcome::kLost);
  CHECK(robot.relocalisation.state() == TrackingState::kAmbiguous);
}

TEST_CASE("hypotheses that scans did not separate stay runners-up when a later search finds another pose") {
  TrackerConfig config;
  config.max_keyframes = 4;
  const Pose twin(Eigen::Translation3d(40, 0, 0)), elsewhere(Eigen::Translation3d(0, 0, 6));
  Displaced robot(config);
  robot.lose_in({Pose::Identity(), twin});
  Attempt attempt;
  auto outcome = Relocalisation::Outcome::kLost;
  int given = 0;
  for (unsigned i = 1; i < 14 && outcome == Relocalisation::Outcome::kLost; ++i) {
    outcome = robot.relocalisation.follow(100000 * i, 0.1, robot.hall.scan(i), robot.odometer, &attempt);
    const bool again = given == 1;
    if (given < 2)
      given += robot.propose(i, again ? std::vector<Pose>() : std::vector<Pose>{twin}, kBelieved,
                             again ? 0.2 : 0.1, again ? elsewhere : Pose::Identity());
  }
  REQUIRE(given == 2);
  CHECK(outcome == Relocalisation::Outcome::kLost);
}

TEST_CASE(
    "a search that excludes all other places ends the doubt that earlier ones left, also during a test") {
  TrackerConfig config;
  config.max_keyframes = 4;
  const Pose twin(Eigen::Translation3d(40, 0, 0));
  for (const bool excluded : {false, true}) {
    for (const unsigned second : {1u, 12u}) {  // scans after the first search: the test takes eight
      CAPTURE(excluded);
      CAPTURE(second);
      Displaced robot(config);
      robot.lose_in({Pose::Identity(), twin});
      Attempt attempt;
      auto outcome = Relocalisation::Outcome::kLost;
      unsigned first = 0;
      int given = 0;
      for (unsigned i = 1; i < 34 && outcome == Relocalisation::Outcome::kLost; ++i) {
        outcome = robot.relocalisation.follow(100000 * i, 0.1, robot.hall.scan(i), robot.odometer, &attempt);
        if (given == 0 && robot.propose(i, {twin})) {
          given = 1;
          first = i;
        } else if (given == 1 && i >= first + second) {
          robot.no_rival = excluded;
          given += robot.propose(i, {}, kBelieved, 0.2);
        }
      }
      REQUIRE(given == 2);
      CHECK((outcome == Relocalisation::Outcome::kFound) == excluded);
    }
  }
}

TEST_CASE("a runner-up that the archive does not show better does not replace the local map") {
  Displaced robot(TrackerConfig{});
  robot.remember({Pose::Identity()});
  robot.lose();
  CHECK(robot.follow(Pose(Eigen::Translation3d(0, 0, 6))) == Relocalisation::Outcome::kFound);
  CHECK(robot.odometer.map().keyframes().size() == 1);
}

TEST_CASE(
    "a search result is tested on the scan at hand and two more, or on three if that one has no points") {
  for (const bool blind : {false, true}) {
    CAPTURE(blind);
    Displaced robot(TrackerConfig{});
    robot.lose_in({Pose::Identity()});
    Attempt attempt;
    const auto follow = [&](unsigned i) {
      return robot.relocalisation.follow(100000 * i, 0.1, robot.hall.scan(i), robot.odometer, &attempt);
    };
    unsigned i = 1;
    for (; i < 20 && !robot.relocalisation.lost_odometry().surroundings().scene; ++i) follow(i);
    if (blind) robot.relocalisation.coast(0.1, robot.odometer);
    REQUIRE(robot.propose(i++, {}));
    int followed = 1;
    while (followed < 10 && follow(i++) == Relocalisation::Outcome::kLost) ++followed;
    CHECK(followed == (blind ? 3 : 2));
  }
}

TEST_CASE("a place that a search finds during a test is tested beside the others, and delays no decision") {
  Displaced robot(TrackerConfig{});
  robot.lose_in({Pose::Identity()});
  const Pose elsewhere(Eigen::Translation3d(0, 0, 6));
  Attempt attempt;
  auto outcome = Relocalisation::Outcome::kLost;
  int given = 0, followed = 0;
  for (unsigned i = 1; i < 20 && outcome == Relocalisation::Outcome::kLost; ++i) {
    outcome = robot.relocalisation.follow(100000 * i, 0.1, robot.hall.scan(i), robot.odometer, &attempt);
    if (given > 0) ++followed;
    if (given < 2)
      given += robot.propose(i, {}, kBelieved, 0.1 + 0.1 * given, given == 0 ? Pose::Identity() : elsewhere);
  }
  REQUIRE(given == 2);
  CHECK(outcome == Relocalisation::Outcome::kFound);
  CHECK(followed == 2);
  CHECK(attempt.alignment.moving.pose.translation().norm() < 0.1);
  const auto ended = robot.relocalisation.take_ended();
  REQUIRE(ended);
  CHECK(ended->search.voxel == 0.1);
}

TEST_CASE("two searches confirm a hypothesis in either order, if their scales differ") {
  for (const bool more_first : {true, false}) {
    for (const bool same_scale : {true, false}) {
      CAPTURE(more_first);
      CAPTURE(same_scale);
      Displaced robot(TrackerConfig{});
      // So rough that the scans lower the log odds as much as they can.
      robot.lose_in({Pose::Identity()}, 0.13f);
      Attempt attempt;
      auto outcome = Relocalisation::Outcome::kLost;
      int given = 0;
      for (unsigned i = 1; i < 40 && outcome == Relocalisation::Outcome::kLost; ++i) {
        outcome = robot.relocalisation.follow(100000 * i, 0.1, robot.hall.scan(i), robot.odometer, &attempt);
        const double share = (given == 0) == more_first ? 0.95 : 0.3, least = kBelieved + kMostOfScans;
        if (given < 2) given += robot.propose(i, {}, share * least, same_scale ? 0.1 : 0.1 + 0.1 * given);
      }
      REQUIRE(given == 2);
      CHECK((outcome == Relocalisation::Outcome::kFound) == !same_scale);
    }
  }
}

TEST_CASE("scans that fit less closely than usual lower the odds of a hypothesis, and new ground does not") {
  for (const std::string map : {"as usual", "rough", "in part"}) {
    CAPTURE(map);
    const bool rough = map == "rough";
    Displaced robot(TrackerConfig{});
    robot.lose_in({Pose::Identity()}, rough ? 0.1f : 0, map != "in part");
    Attempt attempt;
    auto outcome = Relocalisation::Outcome::kLost;
    bool given = false;
    for (unsigned i = 1; i < 20 && outcome == Relocalisation::Outcome::kLost; ++i) {
      outcome = robot.relocalisation.follow(100000 * i, 0.1, robot.hall.scan(i), robot.odometer, &attempt);
      if (!given) given = robot.propose(i, {}, kBelieved - 0.2 * kMostOfScans);
    }
    REQUIRE(given);
    CHECK(attempt.alignment.moving.pose.translation().norm() < (rough ? 0.2 : 0.1));
    CHECK((outcome == Relocalisation::Outcome::kFound) == !rough);
    const auto ended = robot.relocalisation.take_ended();
    REQUIRE(ended);
    CHECK((ended->reason.find("log odds of") == 0) == rough);
  }
}

TEST_CASE("searches that end during the test of a hypothesis raise or lower its odds") {
  for (const bool against : {false, true}) {
    CAPTURE(against);
    Displaced robot(TrackerConfig{});
    robot.lose_in({Pose::Identity()}, against ? 0 : 0.2f);
    Attempt attempt;
    auto outcome = Relocalisation::Outcome::kLost;
    int given = 0, first = 0, second = 0;
    for (int i = 1; i < 20 && outcome == Relocalisation::Outcome::kLost; ++i) {
      const auto at = static_cast<unsigned>(i);
      outcome = robot.relocalisation.follow(100000 * at, 0.1, robot.hall.scan(at), robot.odometer, &attempt);
      // The log odds of the first search and the scans suffice where the scans fit as usual, and not in a
      // rough map.
      const double log_odds = given == 0 ? kBelieved - 0.4 * kMostOfScans
                              : against  ? -2 * kMostOfScans
                                         : kBelieved + 1.5 * kMostOfScans;
      if (given >= 2 || !robot.propose(at, {}, log_odds, 0.1 + 0.1 * given)) continue;
      (++given == 1 ? first : second) = i;
    }
    REQUIRE(given == 2);
    CHECK(second - first < 3);
    CHECK((outcome == Relocalisation::Outcome::kFound) == !against);
  }
}
