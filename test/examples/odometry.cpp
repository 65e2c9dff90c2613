// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// odometry LOG POSES.tum: the poses of the scans on channel LIDAR of an LCM log, in the frame of the first
// scan. The library reads the log and the messages itself: no LCM is linked.
#include <exception>
#include <iostream>
#include <scanlock/log_file.hpp>
#include <scanlock/messages.hpp>
#include <scanlock/odometry.hpp>
#include <scanlock/trajectory_file.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: odometry LOG POSES.tum\n";
    return 2;
  }
  const scanlock::TrackerConfig config;
  scanlock::Mapper mapper(config);
  scanlock::MapWorker worker(config);   // searches for a lost robot, and loop closures
  scanlock::SectorAssembler assembler;  // of scans that come in slices
  scanlock::Trajectory trajectory;
  scanlock::LogReader log(argv[1]);
  while (const auto event = log.next()) {
    if (event->channel != "LIDAR") continue;
    for (const auto& decoded : assembler.add(scanlock::decode_scan(event->data.data(), event->data.size()))) {
      if (decoded.fault != scanlock::DecodeFault::kNone) continue;
      const scanlock::TrackedScan tracked = mapper.track(decoded.scan);
      if (const auto request = mapper.take_request()) mapper.give(worker.work(*request));
      if (tracked.state == scanlock::TrackingState::kTracking)
        trajectory.push_back({1e-6 * static_cast<double>(tracked.utime), tracked.map_from_body});
    }
  }
  scanlock::write_tum(argv[2], trajectory);
  std::cout << trajectory.size() << " poses\n";
} catch (const std::exception& error) {
  std::cerr << "odometry: " << error.what() << "\n";
  return 1;
}
