// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/config.hpp"

#include <doctest/doctest.h>

#include <string>
#include <type_traits>
#include <utility>

#include "daemon/config_keys.hpp"

using namespace scanlock;

namespace {

std::string error_of(const std::string& text) {
  try {
    parse_config(text, "robot.toml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

/// Converts to any type: the largest number of them that initialises an aggregate is the number of its
/// members.
struct Anything {
  template <typename T>
  operator T() const;
};

template <typename T, typename... Args>
auto initialisable(int) -> decltype(T{std::declval<Args>()...}, std::true_type{});
template <typename T, typename... Args>
std::false_type initialisable(...);

template <typename T, typename... Args>
constexpr std::size_t member_count() {
  if constexpr (decltype(initialisable<T, Args..., Anything>(0))::value) {
    return member_count<T, Args..., Anything>();
  } else {
    return sizeof...(Args);
  }
}

std::size_t keys_in(const std::string& section) {
  std::size_t count = 0;
  for (const auto& key : config_keys()) count += key.section == section ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("every member of the configuration has its key") {
  CHECK(keys_in("tracker") + keys_in("recovery") == member_count<TrackerConfig>());
  CHECK(keys_in("mount") == member_count<MountConfig>());
  CHECK(keys_in("map") == member_count<MapConfig>());
  // The mount and the map are one member each.
  CHECK(keys_in("input") + keys_in("output") + 2 == member_count<DaemonConfig>());
}

TEST_CASE("an empty configuration is the default") {
  CHECK(print_config(parse_config("", "x")) == print_config(Config{}));
}

TEST_CASE("the printed default parses back to itself") {
  const std::string text = print_config(Config{});
  CHECK(print_config(parse_config(text, "x")) == text);
  for (const auto& key : config_keys()) CHECK(text.find("\n" + key.name + " = ") != std::string::npos);
}

TEST_CASE("a changed configuration prints and parses back to itself") {
  Config config;
  config.daemon.scan_channels = {"A", "scan \"quoted\" \\ #x"};
  config.daemon.url = "udpm://239.255.76.67:7668?ttl=0";
  config.daemon.mount.x_m = 0.1;
  config.daemon.mount.yaw_deg = -1e-7;
  config.daemon.twist_frame = "body";
  config.daemon.pose_channel = "";
  config.tracker.max_map_points = 12345;
  config.tracker.max_range_m = 1.0 / 3 + 50;
  const Config back = parse_config(print_config(config), "x");
  CHECK(back.daemon.scan_channels == config.daemon.scan_channels);
  CHECK(back.daemon.mount.yaw_deg == config.daemon.mount.yaw_deg);
  CHECK(back.tracker.max_range_m == config.tracker.max_range_m);
  CHECK(print_config(back) == print_config(config));
}

TEST_CASE("the defaults pass their own checks") {
  CHECK_NOTHROW(check_config(Config{}));
}

TEST_CASE("every key has an explanation and a section of its own kind") {
  for (const auto& key : config_keys()) {
    CAPTURE(key.name);
    CHECK(key.help.size() > 10);
    CHECK(key.min < key.max);
  }
}

TEST_CASE("an unknown key is named with file and line and the nearest known one") {
  const std::string error = error_of("[input]\n\nscan_chanels = [\"A\"]\n");
  CHECK(starts_with(error, "robot.toml:3: input.scan_chanels: unknown key"));
  CHECK(error.find("did you mean input.scan_channels?") != std::string::npos);
  CHECK(error_of("[inputs]\n") == "robot.toml:1: inputs: unknown key; did you mean [input]?");
  CHECK(error_of("threads = 2\n") ==
        "robot.toml:1: threads: unknown key; did you mean threads in the table [tracker]?");
  CHECK(starts_with(error_of("tracker = 2\n"), "robot.toml:1: tracker: unknown key"));
}

TEST_CASE("values out of range or of another type are errors") {
  CHECK(starts_with(error_of("[tracker]\nmax_range_m = 0.5"),
                    "robot.toml:2: tracker.max_range_m: 0.5 is not in 1 to"));
  CHECK(starts_with(error_of("[tracker]\nmax_range_m = nan"), "robot.toml:2: tracker.max_range_m"));
  CHECK(starts_with(error_of("[tracker]\nmax_range_m = inf"), "robot.toml:2: tracker.max_range_m"));
  CHECK(starts_with(error_of("[tracker]\nthreads = 1.5"),
                    "robot.toml:2: tracker.threads: expects a whole number"));
  CHECK(starts_with(error_of("[tracker]\nthreads = 99999999999999"),
                    "robot.toml:2: tracker.threads: 99999999999999"));
  CHECK(starts_with(error_of("[tracker]\nthreads = \"2\""), "robot.toml:2: tracker.threads: expects"));
  CHECK(starts_with(error_of("[output]\ntwist_frame = \"map\""),
                    "robot.toml:2: output.twist_frame: \"map\" is none of"));
  CHECK(starts_with(error_of("[input]\nscan_channels = []"), "robot.toml:2: input.scan_channels: has 0"));
  CHECK(starts_with(error_of("[input]\nscan_channels = \"LIDAR\""),
                    "robot.toml:2: input.scan_channels: expects a list"));
  CHECK(starts_with(error_of("[input]\nscan_channels = [\"A\", \"A\"]"),
                    "robot.toml:2: input.scan_channels: \"A\" is there twice"));
  CHECK(starts_with(error_of("[output]\npose_channel = \"" + std::string(64, 'x') + "\""),
                    "robot.toml:2: output.pose_channel: has 64"));
}

TEST_CASE("a key of real type accepts an integer") {
  CHECK(parse_config("[tracker]\nmax_range_m = 80", "x").tracker.max_range_m == 80);
}

TEST_CASE("text that is not TOML is an error with its line") {
  CHECK(starts_with(error_of("[input]\nurl = \n"), "robot.toml:2: not TOML"));
  CHECK(starts_with(error_of("[input]\nurl = \"a\"\nurl = \"b\"\n"), "robot.toml:3: not TOML"));
}

TEST_CASE("a file that cannot be read is an error that names it") {
  for (const std::string path : {"/nonexistent/robot.toml", "/"}) {
    CAPTURE(path);
    try {
      load_config(path);
      FAIL("no error");
    } catch (const ConfigError& error) {
      CHECK(starts_with(error.what(), path));
    }
  }
}

TEST_CASE("values from the command line are checked against the same ranges") {
  Config config;
  config.tracker.threads = 0;
  CHECK_THROWS_AS(check_config(config), ConfigError);
  config = Config{};
  config.daemon.scan_channels = {""};
  CHECK_THROWS_AS(check_config(config), ConfigError);
}

TEST_CASE(
    "a configuration that uses one channel for two purposes is refused, but empty channels may repeat") {
  Config config;
  config.daemon.prior_odometry_channel = config.daemon.pose_channel;
  try {
    check_config(config);
    FAIL("no error");
  } catch (const ConfigError& error) {
    CHECK(starts_with(error.what(),
                      "input.prior_odometry_channel: \"POSE_BODY_CORRECTED\" is output.pose_channel"));
  }
  config = Config{};
  config.daemon.command_channel = "LIDAR";
  CHECK_THROWS_AS(check_config(config), ConfigError);
  config = Config{};
  config.daemon.attitude_channel = config.daemon.prior_odometry_channel = "STATE";
  CHECK_THROWS_AS(check_config(config), ConfigError);
  config = Config{};
  config.daemon.pose_channel = "LIDAR";  // the daemon would take its own poses for scans
  CHECK_THROWS_AS(check_config(config), ConfigError);
  config = Config{};
  config.daemon.recovery_channel = config.daemon.status_channel;
  CHECK_THROWS_AS(check_config(config), ConfigError);
  config = Config{};
  config.daemon.pose_channel = config.daemon.odometry_channel = config.daemon.status_channel = "";
  CHECK_NOTHROW(check_config(config));
}

TEST_CASE("the mount maps the sensor to the body") {
  MountConfig mount;
  mount.x_m = 1;
  mount.yaw_deg = 90;
  const Eigen::Vector3d ahead_of_sensor = body_from_sensor(mount) * Eigen::Vector3d(2, 0, 0);
  CHECK(ahead_of_sensor.isApprox(Eigen::Vector3d(1, 2, 0)));
  mount = MountConfig{};
  mount.pitch_deg = 90;  // nose down, as the right hand turns about y (left)
  CHECK((body_from_sensor(mount) * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 0, -1)));
}
