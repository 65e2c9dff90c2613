// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <signal.h>

#include <cstring>
#include <limits>

#include "listener.hpp"
#include "network.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;
using std::chrono::seconds;
using Bytes = std::vector<std::uint8_t>;

namespace {

// Byte offsets of members in a bot_core.pointcloud2_t with an empty frame_id.
constexpr std::size_t kFrameIdLength = 20, kHeight = 25, kFields = 33, kFirstNameLength = 37;

Bytes with_int32(Bytes bytes, std::size_t at, std::int32_t value) {
  for (int i = 0; i < 4; ++i)
    bytes[at + static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (24 - 8 * i));
  return bytes;
}

bot_core::pointcloud2_t good_scan(std::int64_t utime) {
  return scan_from({}, utime, 16, 360);
}

bot_core::pointcloud2_t filled_with(float value, int points, std::int64_t utime) {
  auto scan = good_scan(utime);
  scan.width = points;
  scan.height = 1;
  scan.row_step = 16 * points;
  scan.data_nbytes = 16 * points;
  scan.data.resize(static_cast<std::size_t>(scan.data_nbytes));
  for (std::size_t at = 0; at < scan.data.size(); at += sizeof value)
    std::memcpy(&scan.data[at], &value, sizeof value);
  return scan;
}

}  // namespace

TEST_CASE("hostile messages are counted one by one, and the daemon keeps running") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  write_file(folder / "fast.toml", "[output]\nstatus_period_s = 0.1\n[input]\nmax_points = 1000000\n");
  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url(), "-c", folder / "fast.toml"});
  REQUIRE(listener.until_ready());
  std::int64_t sent = 0;
  const auto send = [&](const Bytes& bytes) {
    listener.publish("LIDAR", bytes);
    ++sent;
    CAPTURE(sent);
    REQUIRE(listener.until([&] { return listener.status.scans_received == sent; }));
  };
  // The tracker's verdicts arrive later than the counts of received messages.
  const auto settles = [&](std::int64_t(::scanlock::status_t::*counter), std::int64_t value) {
    return listener.until([&] { return listener.status.*counter == value; });
  };
  using Status = ::scanlock::status_t;
  const Bytes good = bytes_of(good_scan(utime_of(0)));
  send(good);
  CHECK(settles(&Status::scans_used, 1));

  send(Bytes(good.begin(), good.end() - 1));
  send(Bytes(good.begin(), good.begin() + 30));
  send(Bytes(good.begin(), good.begin() + 8));
  Bytes longer = good;
  longer.push_back(0);
  send(longer);
  CHECK(settles(&Status::rejected_truncated, 4));

  Bytes unknown = good;
  unknown[0] = static_cast<std::uint8_t>(~unknown[0]);
  send(unknown);
  send({1, 2, 3});
  CHECK(listener.until(
      [&] { return listener.status.rejected_unknown_type + listener.status.rejected_truncated == 6; }));
  CHECK(listener.status.rejected_unknown_type >= 1);

  const std::int64_t before = listener.status.rejected_truncated;
  const std::int32_t kHuge = std::numeric_limits<std::int32_t>::max();
  int bad_sizes = 0;
  for (const std::size_t at : {kFrameIdLength, kHeight, kFields, kFirstNameLength}) {
    for (const std::int32_t value : {-1, kHuge, std::numeric_limits<std::int32_t>::min()}) {
      send(with_int32(good, at, value));
      ++bad_sizes;
    }
  }
  CHECK(listener.until([&] {
    return listener.status.rejected_bad_size + listener.status.rejected_truncated - before == bad_sizes;
  }));
  CHECK(listener.status.rejected_bad_size > 0);
  CHECK_FALSE(listener.status.last_error.empty());

  auto outside = good_scan(utime_of(1));
  outside.fields[2].offset = 14;  // z would end two bytes after the end of the point
  send(bytes_of(outside));
  outside.fields[2].offset = -4;
  send(bytes_of(outside));
  CHECK(settles(&Status::rejected_bad_field, 2));

  send(bytes_of(filled_with(std::numeric_limits<float>::quiet_NaN(), 1000, utime_of(2))));
  send(bytes_of(filled_with(0, 0, utime_of(3))));
  CHECK(settles(&Status::rejected_empty, 2));
  CHECK(listener.status.nonfinite_points >= 1000);

  CHECK(listener.status.scans_used == 1);
  send(bytes_of(filled_with(5, 1, utime_of(4))));
  send(bytes_of(good_scan(utime_of(5))));
  CHECK(listener.until(
      [&] { return listener.odometry.size() >= 2 && listener.odometry.back().utime == utime_of(5); }));
  CHECK(listener.status.scans_replaced == 0);

  daemon.send(SIGINT);
  CHECK(daemon.wait(seconds(2)) == 0);
  CHECK(daemon.errors().find("rejected: LIDAR: ") != std::string::npos);
}

TEST_CASE("scans of a repeated or an earlier time are counted and not used") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());
  for (const std::int64_t utime : {utime_of(0), utime_of(0), utime_of(0) - 50000}) {
    const std::int64_t received = listener.status.scans_received;
    listener.publish("LIDAR", bytes_of(good_scan(utime)));
    REQUIRE(listener.until([&] { return listener.status.scans_received > received; }));
  }
  const int statuses = listener.statuses;
  REQUIRE(listener.until([&] { return listener.statuses > statuses; }));
  CHECK(listener.status.rejected_duplicate_time == 1);
  CHECK(listener.status.rejected_backward_time == 1);
  CHECK(listener.status.scans_used == 1);
  CHECK(listener.odometry.size() == 1);
}

TEST_CASE("a scan without a stamp gets the time of its arrival, and this is reported") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  Listener listener(network.url());
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  REQUIRE(listener.until_ready());
  listener.publish("LIDAR", bytes_of(good_scan(0)));
  REQUIRE(listener.until([&] { return !listener.odometry.empty(); }));
  CHECK(listener.odometry[0].utime == listener.odometry[0].recv_utime);
  CHECK(listener.until([&] { return listener.status.last_error.find("has no time") != std::string::npos; }));
}

TEST_CASE("channel names are literal, and messages of other channels are ignored") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  Listener listener(network.url());
  Process daemon(
      folder, {"scanlockd", "-l", network.url(), "--scan-channel", "/lidar#a.b", "--scan-channel", "SECOND"});
  REQUIRE(listener.until_ready());
  const Bytes scan = bytes_of(good_scan(utime_of(0)));
  listener.publish("/lidar#aXb", scan);
  listener.publish("LIDAR", scan);
  listener.publish("SECOND", scan);
  listener.publish("/lidar#a.b", bytes_of(good_scan(utime_of(1))));
  CHECK(listener.until([&] { return listener.status.scans_received >= 2; }));
  CHECK(listener.status.scans_received == 2);
}
