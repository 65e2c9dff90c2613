// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <scanlock/command_t.hpp>
#include <thread>

#include "../contains.hpp"
#include "io/map_file.hpp"
#include "listener.hpp"
#include "messages/encode_scan.hpp"
#include "network.hpp"
#include "process.hpp"
#include "simulation/simulator.hpp"

using namespace scanlock::test;
using scanlock::Pose;
using scanlock::TrackingState;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

namespace {

constexpr int kSaved = 120,
              kKilled = 140;  // scans of the first run: in the saved map, and sent in all

/// A drive through rooms, with a kidnap while the daemon is down; and the true poses in the map's frame,
/// which is that of the first scan.
struct DriveWithACarry {
  std::vector<std::vector<std::uint8_t>> scans;
  std::vector<Pose> truth;

  DriveWithACarry() {
    scanlock::SimulationConfig config;
    config.world = scanlock::WorldKind::kIndoor;
    config.seconds = 19;
    config.seed = 302;
    config.events = {scanlock::parse_event("kidnap@14")};
    scanlock::Simulator simulator(config);
    Pose map_from_world = Pose::Identity();
    while (const auto simulated = simulator.next()) {
      if (scans.empty()) map_from_world = simulated->world_from_body.inverse();
      scans.push_back(scanlock::encode_pointcloud2(simulated->scan));
      truth.push_back(map_from_world * simulated->world_from_body);
    }
  }
};

std::vector<std::uint8_t> save_command(const std::string& path) {
  scanlock::command_t message{};
  message.utime = 1;
  message.command = scanlock::command_t::SAVE_MAP;
  message.quat[0] = 1;
  message.path = path;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

double metres_off(const scanlock::odometry_t& message, const Pose& truth) {
  return (Eigen::Vector3d(message.pos) - truth.translation()).norm();
}

double degrees_off(const scanlock::odometry_t& message, const Pose& truth) {
  const Eigen::Quaterniond q(message.quat[0], message.quat[1], message.quat[2], message.quat[3]);
  return q.angularDistance(Eigen::Quaterniond(truth.linear())) * 57.29577951308232;
}

/// Publishes a scan and waits for its pose.
const scanlock::odometry_t& answer_to(Listener& listener, const std::vector<std::uint8_t>& scan) {
  const std::size_t before = listener.odometry.size();
  listener.publish("LIDAR", scan);
  REQUIRE(listener.until([&] { return listener.odometry.size() > before; }, seconds(30)));
  return listener.odometry.back();
}

/// Whether the state implies that the pose in the map is known.
bool claims_a_place(const scanlock::odometry_t& message) {
  const auto state = static_cast<TrackingState>(message.state);
  return state == TrackingState::kInitialising || state == TrackingState::kTracking ||
         state == TrackingState::kDegraded;
}

/// The first run: maps, saves on command, drives on, and is killed. Returns the last epoch.
int run_and_kill(const DriveWithACarry& drive, const Network& network, const TemporaryFolder& folder,
                 const std::string& file) {
  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url(), "--map", file});
  REQUIRE(listener.until_ready());
  for (int i = 0; i < kKilled; ++i) {
    const scanlock::odometry_t& pose = answer_to(listener, drive.scans[static_cast<std::size_t>(i)]);
    CHECK(metres_off(pose, drive.truth[static_cast<std::size_t>(i)]) < 0.3);
    if (i + 1 == kSaved) {
      listener.publish("SCANLOCK_COMMAND", save_command(""));
      CHECK(listener.until([&] { return std::filesystem::exists(file); }));
    }
  }
  CHECK(listener.odometry.back().state == static_cast<int>(TrackingState::kTracking));
  daemon.send(SIGKILL);
  CHECK(daemon.wait(seconds(5)) == 128 + SIGKILL);
  return listener.odometry.back().epoch;
}

}  // namespace

TEST_CASE("after kill -9 the daemon relocalises in the saved map and goes on in the same frame" *
          doctest::test_suite("long drives")) {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  const std::string file = folder / "rooms.map";
  const DriveWithACarry drive;
  const int epoch = run_and_kill(drive, network, folder, file);

  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url(), "--map", file});
  REQUIRE(listener.until_ready());
  CHECK(contains(daemon.errors(), "map loaded"));
  int scans_before = -1;
  for (std::size_t i = kKilled; i < drive.scans.size(); ++i) {
    CAPTURE(i);
    const auto begun = Clock::now();
    const scanlock::odometry_t& pose = answer_to(listener, drive.scans[i]);
    CHECK(pose.epoch > epoch);
    // The search gets the time between two scans of a sensor; more where a slow build takes long for a scan.
    if (scans_before < 0)
      std::this_thread::sleep_for(
          std::max<Clock::duration>(std::chrono::milliseconds(70), 8 * (Clock::now() - begun)));
    if (claims_a_place(pose)) {
      CHECK(metres_off(pose, drive.truth[i]) < 0.3);
      CHECK(degrees_off(pose, drive.truth[i]) < 3);
      if (scans_before < 0) scans_before = static_cast<int>(i) - kKilled;
    } else {
      CHECK(scans_before < 0);  // once found, the robot is not lost again
      CHECK(pose.method == static_cast<int>(scanlock::PoseMethod::kPredicted));
    }
  }
  INFO(daemon.errors());
  CHECK(scans_before > 0);  // the first scan alone is not sufficient
  CHECK(listener.odometry.back().state == static_cast<int>(TrackingState::kTracking));
  CHECK(listener.until([&] { return listener.status.recoveries == 1; }));
  CHECK(listener.status.state == static_cast<int>(TrackingState::kTracking));

  // New keyframes extend the map: the next save keeps the old map.
  const std::vector<scanlock::ArchivedKeyframe> known = scanlock::read_map(file).keyframes;
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(5)) == 0);
  // Keyframes of the earlier run may be replaced by new ones of about the same position.
  const std::vector<scanlock::ArchivedKeyframe> saved = scanlock::read_map(file).keyframes;
  for (const scanlock::ArchivedKeyframe& old : known) {
    CHECK(std::any_of(saved.begin(), saved.end(), [&](const scanlock::ArchivedKeyframe& k) {
      return (k.map_from_body.translation() - old.map_from_body.translation()).norm() < 0.5 * old.reach;
    }));
  }
  CHECK_FALSE(std::filesystem::exists(file + ".old"));
}

TEST_CASE("an incomplete map file stops the start and is named") {
  const TemporaryFolder folder;
  const std::string file = folder / "half.map";
  scanlock::SavedMap map;
  scanlock::PointCloud points;
  for (int i = 0; i < 100; ++i) points.push_back({0.1f * static_cast<float>(i), 1, 2});
  map.keyframes.push_back({1, Pose::Identity(), 5, points});
  scanlock::write_map(file, map);
  const auto size = std::filesystem::file_size(file);
  for (const auto left : {size - 1, size / 2, decltype(size){20}, decltype(size){0}}) {
    CAPTURE(left);
    std::filesystem::resize_file(file, left);
    const Result result = run(folder, {"scanlockd", "-l", "udpm://239.255.76.67:7667?ttl=0", "--map", file});
    CHECK(result.code == 1);
    CHECK(contains(result.errors, "half.map: "));
    CHECK(contains(result.errors, "move it away to begin a new map"));
    CHECK(std::filesystem::file_size(file) == left);
  }
}
