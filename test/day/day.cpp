// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// A simulated day in one building: laps of an office ring, a little aside of each other, and the robot
// carried elsewhere each half hour. Scans go from the simulator to the mapper at once, for a log of them
// would not fit on a disk. One line an hour, as JSON: see tools/results.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "daemon/statistics.hpp"
#include "evaluation/metrics.hpp"
#include "geometry/voxel_grid.hpp"
#include "global/cpu_clock.hpp"
#include "mapping/mapper.hpp"
#include "simulation/simulator.hpp"

namespace scanlock {
namespace {

constexpr double kHour_s = 3600, kCarriedEach_s = 1800, kSpeed_mps = 1.2;
// The frame of the map is that of one scan, whose attitude would be all there is to see at the other end of
// the building: the poses of so many seconds are laid over the truth.
constexpr double kAligned_s = 1200;
constexpr double kBack_m = 1;  // nearer to the truth the robot is back, farther off a recovery was wrong

/// Every fourth column of a VLP-16 that fires 1,800 of them in a turn of a tenth of a second.
Scan thinned(const Scan& scan) {
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < scan.points.size(); ++i)
    if (std::lround(18000 * scan.points.time[i]) % 4 == 0) kept.push_back(i);
  Scan few = scan;
  few.points = select(scan.points, kept);
  return few;
}

/// What one hour was like.
struct Hour {
  PosePairs pairs;  // of scans in TRACKING or DEGRADED, but for who is not back yet
  std::vector<double> ms;
  int carried = 0, back_in_2_s = 0, wrong = 0, lost = 0, tracking_far_off = 0;
  double search_ms = 0;
};

void report(int hour, const Hour& seen, const Pose& world_from_map, const Mapper& mapper) {
  const AbsoluteError off =
      seen.pairs.empty() ? AbsoluteError() : absolute_error(position_errors(seen.pairs, world_from_map));
  const auto scans = static_cast<double>(std::max<std::size_t>(seen.ms.size(), 1));
  std::printf("{\"hour\": %d, \"rms_m\": %.4f, \"worst_m\": %.3f, \"carried\": %d, \"back_in_2_s\": %d, ",
              hour, off.rmse, off.max, seen.carried, seen.back_in_2_s);
  std::printf("\"wrong\": %d, \"lost\": %d, \"tracking_far_off\": %d, \"keyframes\": %zu, ", seen.wrong,
              seen.lost, seen.tracking_far_off, mapper.save().keyframes.size());
  std::printf("\"ms\": %.2f, \"p99_ms\": %.2f, \"search_ms\": %.2f}\n",
              std::accumulate(seen.ms.begin(), seen.ms.end(), 0.0) / scans, percentile(seen.ms, 0.99),
              seen.search_ms / scans);
  std::fflush(stdout);
}

void day(LidarKind lidar, int hours, unsigned seed) {
  SimulationConfig config;
  config.world = WorldKind::kIndoor;
  config.lidar = lidar;
  config.seed = seed;
  config.speed_mps = kSpeed_mps;
  config.seconds = hours * kHour_s;
  config.laps = 20 * hours;  // of 250 m: more than it gets to
  for (double t = kCarriedEach_s; t < *config.seconds; t += kCarriedEach_s) {
    SimulationEvent carried{};
    carried.kind = EventKind::kKidnap;
    carried.time_s = t;
    config.events.push_back(carried);
  }
  Simulator simulator(config);
  Mapper mapper{TrackerConfig()};
  MapWorker worker{TrackerConfig()};
  Hour seen;
  Pose world_from_map = Pose::Identity();
  double carried_s = 0;  // when that was; 0: it has come back
  bool is_aligned = false;
  int hour = 1;
  std::size_t events = 0;
  while (const auto scan = simulator.next()) {
    if (!is_aligned && scan->time_s >= kAligned_s) {
      world_from_map = overlay(seen.pairs, Overlay::kSe3);
      is_aligned = true;
    }
    if (scan->time_s >= hour * kHour_s) {
      report(hour++, seen, world_from_map, mapper);
      seen = Hour();
    }
    const Scan few = lidar == LidarKind::kVlp16 ? thinned(scan->scan) : scan->scan;
    CpuClock cpu;
    const TrackedScan tracked = mapper.track(few);
    seen.ms.push_back(cpu.lap());
    if (auto request = mapper.take_request()) mapper.give(worker.work(*request));
    seen.search_ms += cpu.lap();

    if (events < config.events.size() && scan->time_s >= config.events[events].time_s) {
      carried_s = config.events[events++].time_s;
      ++seen.carried;
    }
    const PosePair pair{scan->time_s, 0, tracked.map_from_body, scan->world_from_body};
    const bool near = !is_aligned || position_errors({pair}, world_from_map).front() < kBack_m;
    const bool sure = tracked.state == TrackingState::kTracking || tracked.state == TrackingState::kDegraded;
    const bool jumped = tracked.recovery && tracked.recovery->accepted && !tracked.recovery->loop_closure;
    if (!sure && tracked.state != TrackingState::kInitialising) ++seen.lost;
    if (jumped && !near) ++seen.wrong;
    if (carried_s > 0 && jumped && near) {
      if (scan->time_s - carried_s <= 2) ++seen.back_in_2_s;
      carried_s = 0;
    }
    if (!sure || carried_s > 0) continue;
    if (tracked.state == TrackingState::kTracking && !near) ++seen.tracking_far_off;
    seen.pairs.push_back(pair);
  }
  report(hour, seen, world_from_map, mapper);
}

}  // namespace
}  // namespace scanlock

int main(int argc, char** argv) {
  const std::string lidar = argc > 1 ? argv[1] : "";
  const int hours = argc > 2 ? std::atoi(argv[2]) : 0;
  if (argc < 3 || argc > 4 || (lidar != "planar" && lidar != "vlp16") || hours < 1 || hours > 24) {
    std::fprintf(stderr, "usage: day planar|vlp16 HOURS [SEED], 1 to 24 hours\n");
    return 2;
  }
  scanlock::day(lidar == "planar" ? scanlock::LidarKind::kPlanar : scanlock::LidarKind::kVlp16, hours,
                argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1);
  return 0;
}
