// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <signal.h>

#include <cmath>
#include <filesystem>
#include <scanlock/command_t.hpp>

#include "../contains.hpp"
#include "listener.hpp"
#include "network.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;
using std::chrono::seconds;

namespace {

std::vector<std::uint8_t> command(std::int8_t kind, const std::string& path = "") {
  scanlock::command_t message{};
  message.utime = kFirstUtime;
  message.command = kind;
  message.pos[0] = 7;
  message.quat[0] = 1;
  message.path = path;
  return bytes_of(message);
}

/// Publishes scans of the drive, each after the pose of the one before has arrived.
void drive_along(Listener& listener, int first, int last) {
  for (int i = first; i < last; ++i) {
    const std::size_t before = listener.odometry.size();
    listener.publish("LIDAR", bytes_of(scan_from(place_on_drive(i), utime_of(i), 16, 900)));
    REQUIRE(listener.until([&] { return listener.odometry.size() > before; }));
  }
}

}  // namespace

TEST_CASE("commands over LCM are executed and counted, and invalid ones are explained") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());
  listener.publish("SCANLOCK_COMMAND", command(scanlock::command_t::SET_POSE));
  REQUIRE(listener.until([&] { return listener.status.commands == 1; }));
  drive_along(listener, 0, 4);
  CHECK(listener.odometry.front().pos[0] == doctest::Approx(7).epsilon(0.05));

  listener.publish("SCANLOCK_COMMAND", command(scanlock::command_t::SAVE_MAP, folder / "street.map"));
  CHECK(listener.until([&] { return std::filesystem::exists(folder / "street.map"); }));
  CHECK(listener.until([&] { return listener.status.commands == 2; }));

  const auto epoch = listener.odometry.back().epoch;
  listener.publish("SCANLOCK_COMMAND", command(scanlock::command_t::RESET));
  CHECK(listener.until([&] { return listener.status.commands == 3; }));
  drive_along(listener, 4, 5);
  CHECK(listener.odometry.back().epoch > epoch);

  listener.publish("SCANLOCK_COMMAND", command(scanlock::command_t::LOAD_MAP, folder / "none.map"));
  CHECK(listener.until([&] { return listener.status.commands_rejected == 1; }));
  CHECK(contains(listener.status.last_error, "none.map"));
  listener.publish("SCANLOCK_COMMAND", command(77));
  CHECK(listener.until([&] { return listener.status.commands_rejected == 2; }));
  listener.publish("SCANLOCK_COMMAND", {1, 2, 3});
  CHECK(listener.until([&] { return listener.status.commands_rejected == 3; }));
  CHECK(contains(listener.status.last_error, "SCANLOCK_COMMAND"));
  CHECK(listener.status.commands == 3);
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(2)) == 0);
}

TEST_CASE("scanlock-command reports the result of a command") {
  const TemporaryFolder folder;
  const auto says = [&](const std::vector<std::string>& words) {
    std::vector<std::string> command{"scanlock-command"};
    command.insert(command.end(), words.begin(), words.end());
    return run(folder, command);
  };
  CHECK(says({"walk"}).code == 2);
  CHECK(says({"save"}).code == 2);
  CHECK(says({"set-pose", "1", "2", "x", "0"}).code == 2);
  CHECK(says({}).code == 2);
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const Result alone = says({"-l", network.url(), "--timeout", "0.5", "reset"});
  CHECK(alone.code == 1);
  CHECK(contains(alone.errors, "no status of a daemon on SCANLOCK_STATUS"));

  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());
  CHECK(says({"-l", network.url(), "set-pose", "-3.5", "2", "0", "90"}).code == 0);
  drive_along(listener, 0, 4);
  CHECK(listener.odometry.front().pos[0] == doctest::Approx(-3.5).epsilon(0.05));
  CHECK(listener.odometry.front().quat[3] == doctest::Approx(std::sqrt(0.5)).epsilon(0.05));
  const Result saved = says({"-l", network.url(), "save", folder / "street.map"});
  CHECK(saved.code == 0);
  CHECK(saved.output == (folder / "street.map") + ": the map is saved\n");
  CHECK(std::filesystem::exists(folder / "street.map"));
  CHECK(says({"-l", network.url(), "load", folder / "street.map"}).code == 0);
  const Result missing = says({"-l", network.url(), "load", folder / "none.map"});
  CHECK(missing.code == 1);
  CHECK(contains(missing.errors, "none.map"));
  CHECK(says({"-l", network.url(), "reset"}).code == 0);
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(2)) == 0);
}

TEST_CASE("a clean end saves the map; a damaged map file stops the start and is not modified") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  const std::string file = folder / "street.map";
  {
    Listener listener(network.url());
    Process daemon(folder, {"scanlockd", "-l", network.url(), "--map", file});
    REQUIRE(listener.until_ready());
    CHECK(contains(daemon.errors(), "no map yet"));
    drive_along(listener, 0, 3);
    daemon.send(SIGTERM);
    CHECK(daemon.wait(seconds(2)) == 0);
    CHECK(contains(daemon.errors(), "map saved"));
  }
  {
    Listener listener(network.url());
    Process daemon(folder, {"scanlockd", "-l", network.url(), "--map", file});
    REQUIRE(listener.until_ready());
    CHECK(contains(daemon.errors(), "map loaded"));
    daemon.send(SIGKILL);
    daemon.wait(seconds(2));
  }
  std::string bytes = read_file(file);
  REQUIRE(bytes.size() > 500);
  bytes[500] = static_cast<char>(bytes[500] ^ 1);
  write_file(file, bytes);
  const Result damaged = run(folder, {"scanlockd", "-l", network.url(), "--map", file});
  CHECK(damaged.code == 1);
  CHECK(contains(damaged.errors, "street.map: byte "));
  CHECK(contains(damaged.errors, "damaged"));
  CHECK(read_file(file) == bytes);
}
