// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// relocalise MAP.ply LOG: finds the robot that recorded the scans of a log in a bare cloud. Prints the time
// and the position of the first scan whose pose in the map is accepted.
#include <cstdio>
#include <exception>
#include <iostream>
#include <scanlock/cloud_file.hpp>
#include <scanlock/log_file.hpp>
#include <scanlock/map.hpp>
#include <scanlock/messages.hpp>
#include <scanlock/odometry.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: relocalise MAP.ply LOG\n";
    return 2;
  }
  const scanlock::TrackerConfig config;
  scanlock::Mapper mapper(config);
  scanlock::MapWorker worker(config);
  mapper.load(scanlock::map_of_cloud(scanlock::read_cloud(argv[1]), argv[1], {}), true);
  scanlock::LogReader log(argv[2]);
  while (const auto event = log.next()) {
    const auto decoded = scanlock::decode_scan(event->data.data(), event->data.size());
    if (decoded.fault != scanlock::DecodeFault::kNone) continue;
    const scanlock::TrackedScan tracked = mapper.track(decoded.scan);
    if (const auto request = mapper.take_request()) mapper.give(worker.work(*request));
    if (!tracked.localised || tracked.state != scanlock::TrackingState::kTracking) continue;
    const Eigen::Vector3d p = tracked.map_from_body.translation();
    std::printf("%.6f %.3f %.3f %.3f\n", 1e-6 * static_cast<double>(tracked.utime), p.x(), p.y(), p.z());
    return 0;
  }
  std::cerr << "relocalise: no scan was relocalised in the map\n";
  return 1;
} catch (const std::exception& error) {
  std::cerr << "relocalise: " << error.what() << "\n";
  return 1;
}
