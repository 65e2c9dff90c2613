// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// A simulated day in one building: laps of an office ring with small lateral offsets, and a kidnap each half
// hour. Or hours in a bare cloud of a ring in an office or a town, made by another drive with another sensor:
// the robot starts in that cloud, and is not kidnapped. Scans go from the simulator directly to the mapper,
// because a log of them would not fit on a disk. Prints one line per hour, as JSON: see tools/results.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "daemon/statistics.hpp"
#include "evaluation/metrics.hpp"
#include "geometry/moved_cloud.hpp"
#include "global/cpu_clock.hpp"
#include "mapping/cloud_map.hpp"
#include "mapping/mapper.hpp"
#include "simulation/simulator.hpp"

namespace scanlock {
namespace {

constexpr double kHour_s = 3600, kCarriedEach_s = 1800, kSpeed_mps = 1.2;
// The map's frame is that of the first scan, and an error of its attitude would dominate the position errors
// at the other end of the building: the poses of these first seconds are aligned with the true poses instead.
constexpr double kAligned_s = 1200;
// Largest position error of a correct recovery; beyond it a recovery counts as wrong.
constexpr double kBack_m = 1;

/// The measurements of one hour.
struct Hour {
  PosePairs pairs;  // of scans in TRACKING or DEGRADED, without those between a kidnap and its recovery
  std::vector<double> ms;
  int carried = 0, back_in_2_s = 0, wrong = 0, lost = 0, tracking_far_off = 0;
  int elsewhere = 0;  // scans in TRACKING or DEGRADED in a submap that is not located in the given map
  double search_ms = 0;
};

void report(int hour, const Hour& seen, const Pose& world_from_map, const Mapper& mapper) {
  const AbsoluteError off =
      seen.pairs.empty() ? AbsoluteError() : absolute_error(position_errors(seen.pairs, world_from_map));
  const auto scans = static_cast<double>(std::max<std::size_t>(seen.ms.size(), 1));
  std::printf("{\"hour\": %d, \"rms_m\": %.4f, \"worst_m\": %.3f, \"carried\": %d, \"back_in_2_s\": %d, ",
              hour, off.rmse, off.max, seen.carried, seen.back_in_2_s);
  std::printf(
      "\"wrong\": %d, \"lost\": %d, \"elsewhere\": %d, \"tracking_far_off\": %d, \"keyframes\": %zu, ",
      seen.wrong, seen.lost, seen.elsewhere, seen.tracking_far_off, mapper.save().keyframes.size());
  std::printf("\"ms\": %.2f, \"p99_ms\": %.2f, \"search_ms\": %.2f}\n",
              std::accumulate(seen.ms.begin(), seen.ms.end(), 0.0) / scans, percentile(seen.ms, 0.99),
              seen.search_ms / scans);
  std::fflush(stdout);
}

/// The ring as a bare cloud like that of a survey, in the frame of the world: every fifth scan of one lap.
SavedMap surveyed(SimulationConfig config) {
  config.lidar = LidarKind::kOs1_64;
  config.column_step = 1;
  config.seconds.reset();
  config.laps = 1;
  config.drive_seed = config.seed + 1000;
  config.motion_distortion = false;
  Simulator simulator(config);
  CloudMapBuilder builder(CloudMapOptions{});
  for (int i = 0; const auto scan = simulator.next(); ++i)
    if (i % 5 == 0) builder.add(moved(scan->scan.points, scan->world_from_body));
  return builder.build("survey");
}

/// `bare`: in a bare cloud, and without kidnaps.
void day(WorldKind world, LidarKind lidar, int hours, unsigned seed, bool bare) {
  SimulationConfig config;
  config.world = world;
  config.lidar = lidar;
  config.seed = seed;
  if (lidar == LidarKind::kVlp16) config.column_step = 4;  // 450 points a ring
  if (world == WorldKind::kIndoor) config.speed_mps = kSpeed_mps;
  Mapper mapper{TrackerConfig()};
  if (bare) mapper.load(surveyed(config), true);
  config.seconds = hours * kHour_s;
  config.laps = std::min(100 * hours, 1000);  // more laps than fit into the time; 1000 is the most
  for (double t = kCarriedEach_s; t < *config.seconds && !bare; t += kCarriedEach_s) {
    SimulationEvent carried{};
    carried.kind = EventKind::kKidnap;
    carried.time_s = t;
    config.events.push_back(carried);
  }
  Simulator simulator(config);
  MapWorker worker{TrackerConfig()};
  Hour seen;
  Pose world_from_map = Pose::Identity();
  double carried_s = 0;  // time of the last kidnap; 0: recovered
  bool is_aligned = bare;
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
    CpuClock cpu;
    const TrackedScan tracked = mapper.track(scan->scan);
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
    if (sure && !tracked.localised) ++seen.elsewhere;
    if (jumped && !near) ++seen.wrong;
    if (carried_s > 0 && jumped && near) {
      if (scan->time_s - carried_s <= 2) ++seen.back_in_2_s;
      carried_s = 0;
    }
    if (!sure || !tracked.localised || carried_s > 0) continue;
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
  const std::string bare = argc > 4 ? argv[4] : "";
  const bool known =
      (lidar == "planar" || lidar == "vlp16") && (argc < 5 || bare == "indoor" || bare == "urban");
  if (argc < 3 || argc > 5 || !known || hours < 1 || hours > 24) {
    std::fprintf(stderr,
                 "usage: day planar|vlp16 HOURS [SEED [indoor|urban]], 1 to 24 hours; with a world: from a "
                 "start in its "
                 "bare cloud\n");
    return 2;
  }
  scanlock::day(bare == "urban" ? scanlock::WorldKind::kUrban : scanlock::WorldKind::kIndoor,
                lidar == "planar" ? scanlock::LidarKind::kPlanar : scanlock::LidarKind::kVlp16, hours,
                argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1, argc > 4);
  return 0;
}
