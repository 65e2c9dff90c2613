// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/place_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>

#include "odometry/lost_mode_odometry.hpp"
#include "prepared_hall.hpp"

using namespace scanlock;

namespace {

struct Asked {
  int requests = 0, longest_pause = 0;  ///< scans between two requests
};

/// The requests for a robot at rest during that many scans, when every search finds a hypothesis, or none
/// does.
Asked ask(unsigned scans, bool found, double cost_s = 0) {
  const TrackerConfig config;
  PreparedHall hall(config);
  LostModeOdometry lost_odometry(config, 0, hall.scan(0), {});
  const PreparedScan same = hall.scan(1);
  KeyframeArchive archive(10000000);
  archive.restore({archived(Pose::Identity(), hall_map())});
  PlaceSearch search(0.1, PlaceSearch::Parts::kWide);
  search.begin(Eigen::Vector3d::Zero());
  search.begin_anew();
  Asked asked;
  unsigned last = 0;
  for (unsigned i = 1; i < scans; ++i) {
    lost_odometry.follow(100000 * i, 0.1, same);
    const auto request = search.next(100000 * i, lost_odometry.surroundings(), archive, std::nullopt);
    if (!request) continue;
    if (++asked.requests > 1) asked.longest_pause = std::max(asked.longest_pause, static_cast<int>(i - last));
    last = i;
    REQUIRE(search.take(request->serial, found, false, cost_s));
  }
  return asked;
}

}  // namespace

TEST_CASE("searches without a convincing result are repeated at growing intervals, but never stop") {
  for (const bool found : {false, true}) {
    CAPTURE(found);
    const Asked at_first = ask(20, found), later = ask(120, found);
    CHECK(at_first.requests >= (found ? 10 : 2));
    CHECK(later.requests < (found ? 80 : 20));
    CHECK(later.longest_pause > at_first.longest_pause);
    CHECK(later.longest_pause <= 30);
  }
}

TEST_CASE("searches take a tenth of a core on average, and more only for as long as they have saved it" *
          doctest::test_suite("long drives")) {
  for (const double cost_s : {0.1, 0.5, 3.0}) {
    CAPTURE(cost_s);
    const double spent = cost_s * ask(600, true, cost_s).requests;  // CPU seconds in a minute
    CHECK(spent < 0.1 * 60 + 6 + cost_s);
    CHECK(spent > 0.1 * 60 - cost_s);
  }
}

TEST_CASE("a scene without extent is not searched for") {
  const TrackerConfig config;
  PreparedHall hall(config);
  LostModeOdometry lost_odometry(config, 0, hall.scan(0), {});
  for (unsigned i = 1; i < 5; ++i) lost_odometry.follow(100000 * i, 0.1, hall.scan(1));
  KeyframeArchive archive(10000000);
  archive.restore({archived(Pose::Identity(), hall_map())});
  for (const double scene : {0.0, 5.0}) {
    PlaceSearch search(1.0, PlaceSearch::Parts::kWide);
    search.begin(std::nullopt);
    search.begin_anew();
    const Surroundings seen{lost_odometry.surroundings().map, Pose::Identity(), scene, 5, std::nullopt};
    CHECK(search.next(1, seen, archive, std::nullopt).has_value() == (scene > 0));
  }
}

TEST_CASE(
    "a robot without a known pose is searched first in the most similar part of the map, then elsewhere") {
  const TrackerConfig config;
  PreparedHall hall(config);
  LostModeOdometry lost_odometry(config, 0, hall.scan(0), {});
  KeyframeArchive archive(10000000);
  std::vector<ArchivedKeyframe> places;
  for (int i = 0; i < 5; ++i) {  // rooms of increasing size; the fourth is the hall
    Pose there = Pose::Identity();
    there.translation().x() = 1000.0 * i;
    PointCloud room = hall_map();
    const float scale = 0.25F * static_cast<float>(i + 1);
    for (std::size_t p = 0; p < room.size(); ++p) {
      room.x[p] *= scale;
      room.y[p] *= scale;
    }
    places.push_back(archived(there, room));
  }
  archive.restore(std::move(places));
  PlaceSearch search(1.0, PlaceSearch::Parts::kWide);
  search.begin(std::nullopt);
  search.begin_anew();
  const auto ask_for = [&](unsigned first) {
    for (unsigned i = first; i < first + 100; ++i) {
      lost_odometry.follow(100000 * i, 0.1, hall.scan(1));
      if (auto request = search.next(100000 * i, lost_odometry.surroundings(), archive, std::nullopt))
        return request;
    }
    return std::optional<RecoveryRequest>();
  };
  auto request = ask_for(1);
  REQUIRE(request);
  CHECK(request->target.centre.x() == 3000);
  REQUIRE(search.take(request->serial, true, false, 0));
  request = ask_for(101);  // the part in which a hypothesis was found is searched again
  REQUIRE(request);
  CHECK(request->target.centre.x() == 3000);
  REQUIRE(search.take(request->serial, true, true, 0));
  request = ask_for(201);  // not again, where the part shows little of the source cloud
  REQUIRE(request);
  CHECK(request->target.centre.x() != 3000);
}
