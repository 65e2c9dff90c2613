// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <signal.h>

#include <cmath>
#include <sstream>

#include "../io/recordings.hpp"
#include "listener.hpp"
#include "messages/decode_scan.hpp"
#include "messages/encode_scan.hpp"
#include "network.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

constexpr int kPlayedScans = 16;
#ifdef __SANITIZE_ADDRESS__
const char* const kSpeed =
    "0.2";  // a sanitised tracker is several times slower, and would replace scans at full speed
#else
const char* const kSpeed = "1";
#endif

/// The output of the chain lcm-logplayer -> scanlockd -> lcm-logger.
struct Recorded {
  ::scanlock::status_t status{};
  std::map<std::int64_t, Place> poses;
};

/// Why the chain cannot run here; empty when it can.
std::string lack_of(const Network& network) {
  if (!network.lack().empty()) return network.lack();
  if (possible_receive_buffer() >= 4000000) return "";
  return "a receive buffer of 4 MB is not granted (sysctl -w net.core.rmem_max=8388608)";
}

Recorded play_through(const Network& network, const TemporaryFolder& folder, const std::string& log,
                      int scans) {
  Listener listener(network.url());
  const std::string out = folder / "out.lcmlog";
  Process logger(folder, {"lcm-logger", "--lcm-url=" + network.url() + "&recv_buf_size=8388608",
                          "--flush-interval=20", "-c", "POSE_.*|SCANLOCK_.*", out});
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());
  REQUIRE(listener.until([&] { return !read_log(out).empty(); }));  // the logger receives, too
  Process player(folder, {"lcm-logplayer", "-l", network.url(), "-s", kSpeed, log});
  CHECK(listener.until([&] { return static_cast<int>(listener.poses.size()) >= scans; }, seconds(20)));
  CHECK(player.wait(seconds(5)) == 0);
  // The logger writes received messages when the next one arrives: the daemon runs until all of them are
  // written.
  const int statuses = listener.statuses;
  Recorded recorded;
  CHECK(listener.until(
      [&] {
        recorded.poses = poses_in(read_log(out), "POSE_BODY_CORRECTED");
        return static_cast<int>(recorded.poses.size()) >= scans && listener.statuses > statuses;
      },
      seconds(20)));
  recorded.status = listener.status;
  MESSAGE("from arrival to publishing: " << recorded.status.latency_p50_ms << " ms (p50), "
                                         << recorded.status.latency_p99_ms
                                         << " ms (p99); resident: " << recorded.status.rss_mb << " MB");
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(2)) == 0);
  logger.send(SIGTERM);
  logger.wait(seconds(2));
  return recorded;
}

/// The utime of a scan in the log: it follows the fingerprint in every type that we write.
std::int64_t utime_in(const Event& scan) {
  std::uint64_t utime = 0;
  for (std::size_t i = 8; i < 16; ++i) utime = utime << 8 | scan.data.at(i);
  return static_cast<std::int64_t>(utime);
}

/// The last row of a file of KITTI poses: x and y.
Place last_of(const std::string& path) {
  std::istringstream numbers(read_file(path));
  std::vector<double> all;
  for (double number = 0; numbers >> number;) all.push_back(number);
  REQUIRE(all.size() >= 12);
  return {all[all.size() - 9], all[all.size() - 5], 0};
}

}  // namespace

TEST_CASE("every scan that lcm-logplayer plays has a pose in the log that lcm-logger records") {
  const Network network;
  if (!lack_of(network).empty()) {
    MESSAGE("skipped: " << lack_of(network));
    return;
  }
  const TemporaryFolder folder;
  const std::vector<Event> events = drive(kPlayedScans);
  REQUIRE(events[0].data.size() > 1900000);
  write_log(folder / "in.lcmlog", events);
  const Recorded recorded = play_through(network, folder, folder / "in.lcmlog", kPlayedScans);
  CHECK(recorded.status.scans_received == kPlayedScans);
  CHECK(recorded.status.scans_used == kPlayedScans);
  CHECK(recorded.status.scans_replaced == 0);
  CHECK(recorded.status.kernel_drops == 0);
  CHECK(recorded.status.recv_buf_granted >= 4000000);
  for (int i = 0; i < kPlayedScans; ++i) {
    CAPTURE(i);
    CHECK(recorded.poses.count(utime_of(i)) == 1);
  }
  CHECK(recorded.poses.size() == kPlayedScans);
  CHECK(worst_error(recorded.poses, kPlayedScans) < 0.05);
}

TEST_CASE("the first scans of KITTI 00 end within 8 cm of the reference") {
  const std::string sequence = scanlock::recordings() / "seq/kitti_00_16";
  if (read_file(sequence + "/poses_ref.txt").empty()) {
    MESSAGE("skipped: no seq/kitti_00_16 in $SCANLOCK_DATA or ../shared/data");
    return;
  }
  const Network network;
  if (!lack_of(network).empty()) {
    MESSAGE("skipped: " << lack_of(network));
    return;
  }
  const TemporaryFolder folder;
  REQUIRE(run(folder, {"scanlock-convert", sequence, folder / "in.lcmlog"}).code == 0);
  const std::vector<Event> scans = read_log(folder / "in.lcmlog");
  REQUIRE(scans.size() == kPlayedScans);
  const Recorded recorded = play_through(network, folder, folder / "in.lcmlog", kPlayedScans);
  REQUIRE(recorded.poses.size() == kPlayedScans);
  for (const auto& scan : scans) CHECK(recorded.poses.count(utime_in(scan)) == 1);
  const Place last = recorded.poses.rbegin()->second, reference = last_of(sequence + "/poses_ref.txt");
  CAPTURE(last.x);
  CAPTURE(last.y);
  CHECK(std::hypot(last.x - reference.x, last.y - reference.y) < 0.08);
}

TEST_CASE("a scan sent in sectors gets a pose, also when one sector is lost") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());
  for (int i = 0; i < 4; ++i) {
    const auto whole = bytes_of(scan_from(place_on_drive(i), utime_of(i), 32, 1000));
    auto sectors = scanlock::encode_sectors(scanlock::decode_scan(whole.data(), whole.size()).scan);
    REQUIRE(sectors.size() > 2);
    if (i == 2) sectors.erase(sectors.begin() + 1);
    const auto poses_are = [&](int count) {
      return listener.until([&] { return static_cast<int>(listener.poses.size()) == count; });
    };
    listener.publish("LIDAR", sectors[0]);
    CHECK(poses_are(i));  // when scan 3 begins, the incomplete scan 2 is tracked
    for (std::size_t k = 1; k < sectors.size(); ++k) listener.publish("LIDAR", sectors[k]);
    if (i != 2) CHECK(poses_are(i + 1));
  }
  CHECK(listener.until([&] { return listener.status.scans_incomplete == 1; }));
  std::map<std::int64_t, Place> poses;
  for (const auto& pose : listener.poses) poses[pose.utime] = {pose.pos[0], pose.pos[1], 0};
  CHECK(poses.size() == 4);
  CHECK(worst_error(poses, 4) < 0.05);
}
