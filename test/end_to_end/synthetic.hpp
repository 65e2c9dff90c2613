// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include <bot_core/pointcloud2_t.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace scanlock::test {

/// Messages and logs made with lcm-gen's types and without code of scanlock, so that the tests are
/// independent of it.

struct Place {
  double x = 0, y = 0, yaw = 0;  ///< metres, radians; the sensor stands 1.7 m above the ground
};

/// A drive along a street: 8 m/s, turning slowly. Scan i is taken at time i / 10 s.
Place place_on_drive(int scan);

/// The scan of a sensor with `rings` x `columns` rays in a street of boxes at `place`, without motion
/// distortion.
bot_core::pointcloud2_t scan_from(const Place& place, std::int64_t utime, int rings, int columns);

/// The encoded bytes of a message.
template <typename Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// An event of an LCM log.
struct Event {
  std::int64_t utime = 0;
  std::string channel;
  std::vector<std::uint8_t> data;
};
template <typename Message>
Message decoded(const Event& event) {
  Message message{};
  REQUIRE(message.decode(event.data.data(), 0, static_cast<int>(event.data.size())) > 0);
  return message;
}
void write_log(const std::string& path, const std::vector<Event>& events);
std::vector<Event> read_log(const std::string& path);

/// The bot_core.pose_t of a channel, by their utime.
std::map<std::int64_t, Place> poses_in(const std::vector<Event>& events, const std::string& channel);

/// The drive as events of 2 MB on LIDAR, ten a second.
constexpr std::int64_t kFirstUtime = 1700000000000000;
std::vector<Event> drive(int scans, int rings = 64, int columns = 1900);
std::int64_t utime_of(int scan);

/// The largest position error of the estimate, relative to the first scan; metres.
double worst_error(const std::map<std::int64_t, Place>& poses, int scans);

}  // namespace scanlock::test
