// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/pipeline.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "../io/temporary_directory.hpp"
#include "../odometry/room.hpp"
#include "io/map_file.hpp"

using namespace scanlock;

namespace {

/// A pipeline and its output.
class Bench {
 public:
  explicit Bench(const Config& config, Pipeline::Mode mode = Pipeline::Mode::kLive)
      : pipeline_(config, statistics_, mode) {}

  void scan(std::int64_t number, const PriorSample& prior = {}) { scan_at(1000000 + 100000 * number, prior); }
  void scan_at(std::int64_t utime, const PriorSample& prior = {}) {
    ReceivedScan received;
    received.prior = prior;
    received.scan = hall_scan(Pose::Identity(), Vector6::Zero(), utime, 5);
    tracked_.push_back(pipeline_.process(received).tracked);
  }
  void command(CommandKind kind, const std::string& path = "", const Pose& pose = Pose::Identity()) {
    pipeline_.execute({0, kind, pose, path});
  }
  std::vector<TrackedScan> end() {
    pipeline_.finish();
    return tracked_;
  }
  const std::vector<TrackedScan>& tracked() const { return tracked_; }
  Counters counters() const { return statistics_.report().counters; }

 private:
  Statistics statistics_;
  Pipeline pipeline_;
  std::vector<TrackedScan> tracked_;
};

}  // namespace

TEST_CASE("set_pose sets the pose of the body, not that of the sensor") {
  Config config;
  config.daemon.mount.x_m = 1.5;
  config.daemon.mount.yaw_deg = 90;
  Vector6 xi;
  xi << 10, -4, 0.5, 0, 0, 2;
  const Pose there = se3_exp(xi);
  Bench bench(config);
  bench.command(CommandKind::kSetPose, "", there);
  bench.scan(0);
  const std::vector<TrackedScan> tracked = bench.end();
  REQUIRE(tracked.size() == 1);
  CHECK(tracked[0].map_from_body.isApprox(there, 1e-9));
  CHECK(bench.counters().commands == 1);
}

TEST_CASE("a reset begins a new epoch between two scans") {
  Bench bench{Config{}};
  bench.scan(0);
  bench.scan(1);
  bench.command(CommandKind::kReset);
  bench.scan(2);
  const std::vector<TrackedScan> tracked = bench.end();
  REQUIRE(tracked.size() == 3);
  CHECK(tracked[1].epoch == tracked[0].epoch);
  CHECK(tracked[2].epoch > tracked[1].epoch);
  CHECK(tracked[2].state == TrackingState::kInitialising);
}

TEST_CASE("a map is saved on command and loaded again") {
  const TemporaryDirectory folder;
  Bench bench{Config{}};
  bench.scan(0);
  bench.scan(1);
  bench.command(CommandKind::kSaveMap, folder / "hall.map");
  bench.scan(2);
  bench.end();
  CHECK(bench.counters().commands == 1);
  const SavedMap map = read_map(folder / "hall.map");
  REQUIRE(map.keyframes.size() >= 1);
  CHECK(map.keyframes[0].points.size() > 100);

  Bench again{Config{}};
  again.command(CommandKind::kLoadMap, folder / "hall.map");
  again.scan(0);
  const std::vector<TrackedScan> tracked = again.end();
  CHECK(again.counters().commands == 1);
  REQUIRE(tracked.size() == 1);
  CHECK(tracked[0].epoch > map.epoch);
}

TEST_CASE("commands that cannot be executed are counted and explained, and change nothing") {
  const TemporaryDirectory folder;
  write_file(folder / "damaged.map", std::string("\x89SLMAP\r\n and so on"));
  Bench bench{Config{}};
  bench.scan(0);
  bench.command(CommandKind::kLoadMap, folder / "missing.map");
  bench.command(CommandKind::kSaveMap);  // without a path
  bench.command(CommandKind::kLoadMap, folder / "damaged.map");
  bench.scan(1);
  const std::vector<TrackedScan> tracked = bench.end();
  CHECK(bench.counters().commands == 0);
  CHECK(bench.counters().commands_rejected == 3);
  CHECK(bench.counters().last_error.find("damaged.map") != std::string::npos);
  REQUIRE(tracked.size() == 2);
  CHECK(tracked[1].state == TrackingState::kTracking);
  CHECK(tracked[1].epoch == tracked[0].epoch);
}

TEST_CASE("the configured map is written on exit and found at the next start") {
  const TemporaryDirectory folder;
  Config config;
  config.daemon.map.file = folder / "hall.map";
  {
    Bench bench(config);
    bench.scan(0);
    bench.scan(1);
    bench.end();
  }
  const SavedMap map = read_map(config.daemon.map.file);
  CHECK_FALSE(map.keyframes.empty());
  Bench again(config);
  again.scan(0);
  const std::vector<TrackedScan> tracked = again.end();
  REQUIRE(tracked.size() == 1);
  CHECK(tracked[0].epoch > map.epoch);
}

TEST_CASE("a damaged map file stops the start and is not modified") {
  const TemporaryDirectory folder;
  Config config;
  config.daemon.map.file = folder / "hall.map";
  {
    Bench bench(config);
    for (int i = 0; i < 3; ++i) bench.scan(i);
    bench.end();
  }
  Bytes bytes = file_bytes(config.daemon.map.file);
  REQUIRE(bytes.size() > 300);
  bytes[300] ^= 4;
  write_file(config.daemon.map.file, bytes);
  CHECK_THROWS_AS(Bench{config}, std::runtime_error);
  CHECK(file_bytes(config.daemon.map.file) == bytes);
}

TEST_CASE("a map that the new map does not continue is kept as .old") {
  const TemporaryDirectory folder;
  Config config;
  config.daemon.map.file = folder / "hall.map";
  {
    Bench bench(config);
    for (int i = 0; i < 3; ++i) bench.scan(i);
    bench.end();
  }
  const Bytes before = file_bytes(config.daemon.map.file);
  {
    Bench bench(config);
    bench.command(CommandKind::kReset);
    for (int i = 3; i < 6; ++i) bench.scan(i);
    bench.end();
  }
  CHECK(file_bytes(folder / "hall.map.old") == before);
  CHECK(read_map(config.daemon.map.file).keyframes.at(0).utime > 1000000 + 100000 * 2);
}

TEST_CASE("a map of one cloud that is replaced by a map of another cloud is kept as .old") {
  const TemporaryDirectory folder;
  const auto write = [&](const std::string& path, float reach) {
    const Scan scan = hall_scan(Pose::Identity(), Vector6::Zero(), 0, 5);
    SavedMap map;  // keyframes of a map of a cloud have their numbers as utime
    for (int i = 1; i <= 3; ++i)
      map.keyframes.push_back({i, Pose(Eigen::Translation3d(i, 0, 0)), reach, scan.points, {}});
    write_map(path, map);
  };
  Config config;
  config.daemon.map.file = folder / "one.map";
  write(config.daemon.map.file, 8);
  write(folder / "other.map", 9);
  const Bytes before = file_bytes(config.daemon.map.file);
  Bench bench(config);
  bench.command(CommandKind::kLoadMap, folder / "other.map");
  bench.end();
  CHECK(file_bytes(config.daemon.map.file + ".old") == before);
  CHECK(read_map(config.daemon.map.file).keyframes.at(0).reach == 9);
}

TEST_CASE("a grown map beside a newer cloud is used, and the newer cloud is reported") {
  const TemporaryDirectory folder;
  SavedMap map;
  map.keyframes.push_back(
      {1, Pose::Identity(), 8, hall_scan(Pose::Identity(), Vector6::Zero(), 0, 5).points, {}});
  write_map(folder / "site.map", map);
  write_file(folder / "site.ply", Bytes{'n', 'o', 'n', 'e'});
  Config config;
  config.daemon.map.file = folder / "site.ply";
  config.daemon.map.mode = "extend";
  const auto told = [&](std::chrono::hours age) {
    std::filesystem::last_write_time(folder / "site.ply",
                                     std::filesystem::last_write_time(folder / "site.map") - age);
    Bench bench(config);
    return bench.counters().last_error;
  };
  CHECK(told(std::chrono::hours(1)).empty());
  CHECK(told(std::chrono::hours(-1)).find("which is newer") != std::string::npos);
}

TEST_CASE("a map that could not be saved later is an error at the start") {
  Config config;
  config.daemon.map.file = "/nonexistent/folder/hall.map";
  CHECK_THROWS_AS(Bench{config}, std::runtime_error);
}

TEST_CASE("without a scan no map file appears") {
  const TemporaryDirectory folder;
  Config config;
  config.daemon.map.file = folder / "hall.map";
  Bench(config).end();
  CHECK_FALSE(std::filesystem::exists(config.daemon.map.file));
}

TEST_CASE("odometry that contradicts the scans is reported and does not affect the pose") {
  Bench bench{Config{}};
  for (int i = 0; i < 12; ++i) {
    PriorSample prior;
    prior.odometry = Pose(Eigen::Translation3d(1.0 * i, 0, 0));  // while the robot stands
    bench.scan(i, prior);
  }
  const std::vector<TrackedScan> tracked = bench.end();
  CHECK(bench.counters().priors_contradicting >= 5);
  CHECK(bench.counters().last_error.find("odometry prior contradicts the scans") != std::string::npos);
  REQUIRE(tracked.size() == 12);
  CHECK(tracked.back().state == TrackingState::kTracking);
  CHECK(tracked.back().map_from_body.translation().norm() < 0.05);
}

TEST_CASE("a map that cannot be written is a failure at exit and a rejected command") {
  const TemporaryDirectory folder;
  Config config;
  config.daemon.map.file = folder / "hall.map";
  Bench bench(config);
  for (int i = 0; i < 3; ++i) bench.scan(i);
  bench.command(CommandKind::kSaveMap, "/nonexistent/folder/hall.map");
  std::filesystem::create_directory(config.daemon.map.file);  // a directory in the place of the file
  CHECK_THROWS_WITH_AS(bench.end(), doctest::Contains("hall.map"), std::runtime_error);
  CHECK(bench.counters().commands == 0);
  CHECK(bench.counters().commands_rejected == 1);
}

TEST_CASE("a replay writes none of the files that its log names") {
  const TemporaryDirectory folder;
  Bench bench(Config{}, Pipeline::Mode::kReplay);
  for (int i = 0; i < 3; ++i) bench.scan(i);
  bench.command(CommandKind::kSaveMap, folder / "hall.map");
  bench.end();
  CHECK(bench.counters().commands_rejected == 1);
  CHECK_FALSE(std::filesystem::exists(folder / "hall.map"));
}

TEST_CASE("a step of the clock is counted and reported, and changes neither map nor epoch") {
  Bench bench{Config{}};
  for (int i = 0; i < 5; ++i) bench.scan(i);
  for (int i = 0; i < 5; ++i) bench.scan_at(7000000000 + 100000 * i);
  const std::vector<TrackedScan> tracked = bench.end();
  CHECK(bench.counters().clock_steps == 1);
  CHECK(bench.counters().last_error.find("1400000") != std::string::npos);
  CHECK(bench.counters().last_error.find("7000200000") != std::string::npos);
  CHECK(tracked.back().state == TrackingState::kTracking);
  CHECK(tracked.back().epoch == tracked.front().epoch);
  CHECK(tracked.back().map_from_body.translation().norm() < 0.02);
}

TEST_CASE("a pose is not localised before a hypothesis in the loaded map is accepted") {
  const TemporaryDirectory folder;
  Config config;
  config.daemon.map.file = folder / "hall.map";
  {
    Bench bench(config);
    for (int i = 0; i < 3; ++i) bench.scan(i);
    CHECK(bench.end().back().localised);
  }
  Bench again(config);
  again.scan(0);
  again.scan(1);
  CHECK_FALSE(again.end().back().localised);
}

/// A daemon whose map file is overwritten in place while it is used.
struct Overwritten {
  TemporaryDirectory folder;
  Config config;
  Bytes good, damaged;

  Overwritten() {
    config.daemon.map.file = folder / "hall.map";
    Bench bench(config);
    for (int i = 0; i < 3; ++i) bench.scan(i);
    bench.end();
    good = file_bytes(config.daemon.map.file);
    damaged = Bytes(good.begin(), good.begin() + 200);
  }
};

TEST_CASE("a map file that is overwritten in place is reported" * doctest::test_suite("long drives")) {
  Overwritten map;
  const std::string& file = map.config.daemon.map.file;
  Bench bench(map.config, Pipeline::Mode::kReplay);
  write_file(file, map.damaged);
  for (int i = 100; i < 103; ++i) bench.scan(i);
  const Counters counters = bench.counters();
  CHECK(counters.map_faults > 0);
  CHECK(counters.last_error ==
        file + ": cannot read all of its " + std::to_string(map.good.size()) +
            " bytes; points of the loaded map cannot be read: load a map again, and replace map files only "
            "with mv");
  CHECK(file_bytes(file) == map.damaged);
}

TEST_CASE("a map file that is overwritten in place costs no scan, and another map can be loaded" *
          doctest::test_suite("long drives")) {
  Overwritten map;
  Bench bench(map.config, Pipeline::Mode::kReplay);
  write_file(map.config.daemon.map.file, map.damaged);
  for (int i = 100; i < 110; ++i) bench.scan(i);
  write_file(map.folder / "again.map", map.good);
  bench.command(CommandKind::kLoadMap, map.folder / "again.map");
  const std::int64_t faults = bench.counters().map_faults;
  for (int i = 110; i < 140; ++i) bench.scan(i);
  const std::vector<TrackedScan> tracked = bench.tracked();
  CHECK(bench.counters().map_faults == faults);
  for (const TrackedScan& scan : tracked) CHECK(scan.verdict == ScanVerdict::kTracked);
  for (std::size_t i = 1; i < 10; ++i) CHECK(tracked[i].epoch == tracked[0].epoch);
  CHECK(tracked.back().localised);
  CHECK(tracked.back().state == TrackingState::kTracking);
  CHECK(file_bytes(map.config.daemon.map.file) == map.damaged);
}
