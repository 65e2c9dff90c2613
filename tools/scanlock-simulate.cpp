// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-simulate: drives a simulated LiDAR through a world into an LCM log, with exact truth.
#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "io/lcm_log.hpp"
#include "io/output_files.hpp"
#include "io/progress_bar.hpp"
#include "io/scan_directory.hpp"
#include "io/trajectory.hpp"
#include "messages/encode_scan.hpp"
#include "simulation/simulator.hpp"

namespace {

using namespace scanlock;

struct Options {
  std::string world = "urban", lidar = "vlp16", stamp = "begin", channel = "LIDAR";
  std::vector<std::string> events;
  std::string log, truth, bin;
  double noise = -1, moved_percent = 0;
  bool no_distortion = false, json = false, force = false;
  SimulationConfig config;
};

void declare(CommandLine line, Options& options) {
  line.explain("", {"scanlock-simulate drive.lcmlog --world indoor --seconds 30 --truth truth.tum",
                    "scanlock-simulate drive.lcmlog --lidar os1-64 --event kidnap@20 --event blackout@40+2"});
  options.config.threads = machine_threads();
  line.option("--world", options.world, "urban, indoor, forest, tunnel or field").default_shown();
  line.option("--lidar", options.lidar, "vlp16, hdl64, os1-64, mid360 or planar").default_shown();
  line.option(
      "--seconds", options.config.seconds,
      "length of the drive (default: 60, or with --laps the duration of the laps); with both, the drive "
      "ends at the earlier of the two");
  line.option(
      "--laps", options.config.laps,
      "drive a closed loop this many times, and 10 m more, each lap slightly beside the last one. "
      "urban: around blocks, about 600 m a lap; forest and field: the usual round, about 330 and 440 m; "
      "indoor: a ring of about 250 m with offices on both sides, on another floor than without laps; "
      "tunnel has no laps");
  line.option("--seed", options.config.seed, "seed of the world, the route and the noise")
      .from_zero()
      .default_shown();
  line.option(
          "--drive-seed", options.config.drive_seed,
          "seed of another drive in the world of --seed: of its route (urban and indoor), traffic and noise")
      .from_zero();
  line.option(
          "--moved", options.moved_percent,
          "percent of the furniture (indoor), or of parked cars and bins (urban), that are moved; the seed "
          "of the drive selects them")
      .default_shown();
  line.option("--event", options.events,
              "may be repeated; T and D in seconds: kidnap@T (the sensor is carried 3 to 15 m and turned), "
              "blackout@T+D "
              "(scans empty or of at most 20 points), shake@T+D (strong rotations), halfview@T+D (nothing "
              "seen to "
              "the left), dropout@T+D (scans missing altogether)")
      .repeated();  // one event per option: the word after it may be the log
  line.option("--speed", options.config.speed_mps, "cruising speed in m/s instead of the world's own");
  line.option("--start-speed", options.config.start_speed_mps,
              "speed in m/s at the start, from which the drive brakes or accelerates to its cruising speed")
      .default_shown();
  line.option("--noise", options.noise, "standard deviation of ranges in metres instead of the sensor's own")
      .from_zero();
  line.flag("--no-distortion", options.no_distortion, "measure all points of a scan at its stamp");
  line.option("--stamp", options.stamp, "stamp the begin or the end of each sweep")
      .one_of({"begin", "end"})
      .default_shown();
  line.option("--channel", options.channel, "channel of the scans").channel().default_shown();
  line.option("--truth", options.truth, "also write the sensor's exact pose at each scan's stamp (TUM)");
  line.option(
      "--bin", options.bin,
      "also write the scans to this directory: NNNNNN.bin (KITTI), ptime/NNNNNN.f32 and times.txt, as "
      "scanlock-convert reads them");
  line.option("--threads", options.config.threads, "worker threads; the result does not depend on them")
      .default_shown();
  line.flag("--force", options.force, "overwrite outputs that are there already");
  line.flag("--json", options.json, "print one JSON object on standard output");
  line.option("LOG", options.log, "the LCM log to write").required();
}

/// Parses the words of the command line; throws UsageError.
void settle(Options& options) try {
  options.config.world = parse_world(options.world);
  options.config.lidar = parse_lidar(options.lidar);
  for (const std::string& text : options.events) options.config.events.push_back(parse_event(text));
  if (options.noise >= 0) options.config.noise_m = options.noise;
  options.config.motion_distortion = !options.no_distortion;
  options.config.moved = options.moved_percent / 100;
  options.config.stamp_at_end = options.stamp == "end";
} catch (const std::invalid_argument& error) {
  throw UsageError(error.what());
}

Simulator simulator_of(const SimulationConfig& config) try {
  return Simulator(config);
} catch (const std::invalid_argument& error) {  // the simulator cannot do what the configuration asks for
  throw UsageError(error.what());
}

/// Intensities as in KITTI's files: 0 to 1.
Scan as_kitti(Scan scan) {
  for (float& intensity : scan.points.intensity) intensity /= 255;
  return scan;
}

struct Summary {
  std::int64_t scans = 0, points = 0;
  double distance_m = 0, elapsed_s = 0;
  double lap_m = 0;  // 0: no laps
};

Summary run(const Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  check_outputs({{}, {options.log, options.truth}, options.bin}, options.force);
  Simulator simulator = simulator_of(options.config);
  LogWriter log(options.log);
  std::optional<ScanDirectoryWriter> directory;
  if (!options.bin.empty()) directory.emplace(options.bin, options.force);
  ProgressBar bar("scans");
  Trajectory truth;
  Summary summary;
  summary.lap_m = simulator.world().lap_m;
  while (const auto simulated = simulator.next()) {
    ScanTags tags;
    tags.seq = static_cast<std::int32_t>(simulator.position() - 1);
    log.write(simulated->scan.utime, options.channel, encode_pointcloud2(simulated->scan, tags));
    if (directory) directory->write(as_kitti(simulated->scan));
    if (!truth.empty())
      summary.distance_m +=
          (simulated->world_from_body.translation() - truth.back().pose.translation()).norm();
    truth.push_back({static_cast<double>(simulated->scan.utime) * 1e-6, simulated->world_from_body});
    ++summary.scans;
    summary.points += static_cast<std::int64_t>(simulated->scan.points.size());
    bar.update(static_cast<std::uint64_t>(simulator.position()),
               static_cast<std::uint64_t>(simulator.sweeps()));
  }
  log.close();
  if (directory) directory->close();
  if (!options.truth.empty()) write_tum(options.truth, truth);
  summary.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f m", length);
  return text;
}

void report(const Options& options, const Summary& summary) {
  if (options.json) {
    nlohmann::ordered_json json = {{"scans", summary.scans},
                                   {"points", summary.points},
                                   {"distance_m", summary.distance_m},
                                   {"elapsed_s", summary.elapsed_s}};
    if (summary.lap_m > 0) json["lap_m"] = summary.lap_m;
    print_json(json);
  } else {
    const std::string lap = summary.lap_m > 0 ? " in laps of " + metres(summary.lap_m) : "";
    std::printf("%s: %lld scans, %lld points, %s driven%s (%s, %s), made in %.1f s\n", options.log.c_str(),
                static_cast<long long>(summary.scans), static_cast<long long>(summary.points),
                metres(summary.distance_m).c_str(), lap.c_str(), options.world.c_str(), options.lidar.c_str(),
                summary.elapsed_s);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<Options>("scanlock-simulate",
                              "Drives a simulated LiDAR through a world into an LCM log, with exact truth.",
                              argc, argv, declare, [](Options& options) {
                                settle(options);
                                report(options, run(options));
                                return 0;
                              });
}
