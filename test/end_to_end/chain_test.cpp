// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <signal.h>

#include "listener.hpp"
#include "network.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

constexpr int kScans = 16;
#ifdef __SANITIZE_ADDRESS__
const char* const kSpeed =
    "0.2";  // a sanitised tracker is several times slower; losing scans would be right then
#else
const char* const kSpeed = "1";
#endif

}  // namespace

TEST_CASE("every scan that lcm-logplayer plays has its pose in what lcm-logger records") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  if (possible_receive_buffer() < 4000000) {
    MESSAGE("skipped: a receive buffer of 4 MB is not granted (sysctl -w net.core.rmem_max=8388608)");
    return;
  }
  const TemporaryFolder folder;
  const std::vector<Event> events = drive(kScans);
  REQUIRE(events[0].data.size() > 1900000);
  write_log(folder / "in.lcmlog", events);

  Listener listener(network.url());
  Process logger(folder, {"lcm-logger", "--lcm-url=" + network.url() + "&recv_buf_size=8388608",
                          "--flush-interval=20", "-c", "POSE_.*|SCANLOCK_.*", folder / "out.lcmlog"});
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());                                                    // the daemon is there
  REQUIRE(listener.until([&] { return !read_log(folder / "out.lcmlog").empty(); }));  // and so is the logger
  Process player(folder, {"lcm-logplayer", "-l", network.url(), "-s", kSpeed, folder / "in.lcmlog"});
  CHECK(listener.until([&] { return listener.poses.size() >= kScans; }, seconds(20)));
  CHECK(player.wait(seconds(5)) == 0);
  const int statuses = listener.statuses;
  CHECK(listener.until([&] { return listener.statuses > statuses; }));
  CAPTURE(daemon.errors());
  CHECK(listener.status.scans_received == kScans);
  CHECK(listener.status.scans_used == kScans);
  CHECK(listener.status.scans_replaced == 0);
  CHECK(listener.status.kernel_drops == 0);
  CHECK(listener.status.recv_buf_granted >= 4000000);

  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(2)) == 0);
  std::map<std::int64_t, Place> poses;
  CHECK(listener.until(
      [&] {
        poses = poses_in(read_log(folder / "out.lcmlog"), "POSE_BODY_CORRECTED");
        return poses.size() >= kScans;
      },
      seconds(3)));
  logger.send(SIGTERM);
  logger.wait(seconds(2));
  for (int i = 0; i < kScans; ++i) {
    CAPTURE(i);
    CHECK(poses.count(utime_of(i)) == 1);
  }
  CHECK(poses.size() == kScans);
  CHECK(worst_error(poses, kScans) < 0.1);
}

TEST_CASE("a replay from a file loses nothing and gives the same poses twice") {
  const Network network;
  const TemporaryFolder folder;
  write_log(folder / "in.lcmlog", drive(kScans, 16, 900));
  std::vector<Event> first;
  for (const std::string out : {"a.lcmlog", "b.lcmlog"}) {
    const Result result = run(folder, {"scanlockd", "-l", "file://" + (folder / "in.lcmlog") + "?speed=0",
                                       "--out-url", "file://" + (folder / out) + "?mode=w"});
    CAPTURE(result.errors);
    CHECK(result.code == 0);
    std::vector<Event> published;
    for (const auto& event : read_log(folder / out)) {
      if (event.channel != "SCANLOCK_STATUS") published.push_back(event);  // it says how this run went
    }
    CHECK(poses_in(published, "POSE_BODY_CORRECTED").size() == kScans);
    CHECK(worst_error(poses_in(published, "POSE_BODY_CORRECTED"), kScans) < 0.1);
    if (first.empty()) first = published;
    REQUIRE(published.size() == first.size());
    for (std::size_t i = 0; i < first.size(); ++i) CHECK(published[i].data == first[i].data);
  }
}
