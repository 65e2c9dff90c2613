// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "daemon/config.hpp"
#include "daemon/replay.hpp"
#include "daemon/statistics.hpp"
#include "io/progress_bar.hpp"
#include "io/trajectory.hpp"

namespace {

using namespace scanlock;
using Json = nlohmann::ordered_json;

struct Options {
  ReplayOptions replay;
  std::string config_path, tum_path, kitti_path;
  std::vector<std::string> channels;
  int threads = 0;
  bool json = false;
};

Json summary(const ReplayResult& result) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  const std::vector<double>& ms = result.scan_ms;
  const double sum = std::accumulate(ms.begin(), ms.end(), 0.0);
  const auto state = [&](TrackingState s) { return result.states[static_cast<std::size_t>(s)]; };
  return {{"scans", result.scans},
          {"poses", result.trajectory.size()},
          {"distance_m", result.distance_m},
          {"states",
           {{"tracking", state(TrackingState::kTracking)},
            {"degraded", state(TrackingState::kDegraded)},
            {"recovering", state(TrackingState::kRecovering)},
            {"lost", state(TrackingState::kLost)},
            {"ambiguous", state(TrackingState::kAmbiguous)},
            {"initialising", state(TrackingState::kInitialising)}}},
          {"recoveries", result.recoveries},
          {"false_starts", result.false_starts},
          {"rejected", result.rejected},
          {"bad_times", result.bad_times},
          {"ms",
           {{"p50", percentile(ms, 0.5)},
            {"p95", percentile(ms, 0.95)},
            {"p99", percentile(ms, 0.99)},
            {"max", percentile(ms, 1.0)},
            {"mean", ms.empty() ? 0.0 : sum / static_cast<double>(ms.size())}}},
          {"cpu_s", seconds(usage.ru_utime) + seconds(usage.ru_stime)},
          {"peak_rss_mb", static_cast<double>(usage.ru_maxrss) * 1024e-6}};
}

void print(const Json& s) {
  const Json &states = s["states"], &ms = s["ms"];
  std::cout << "scans " << s["scans"] << ", poses " << s["poses"] << ", way " << s["distance_m"] << " m\n"
            << "states: tracking " << states["tracking"] << ", degraded " << states["degraded"]
            << ", recovering " << states["recovering"] << ", ambiguous " << states["ambiguous"] << ", lost "
            << states["lost"] << "\n"
            << "ms a scan: p50 " << ms["p50"] << ", p95 " << ms["p95"] << ", p99 " << ms["p99"] << ", max "
            << ms["max"] << "; CPU " << s["cpu_s"] << " s, peak memory " << s["peak_rss_mb"] << " MB\n";
}

int run(const Options& options) {
  Config config = options.config_path.empty() ? Config{} : load_config(options.config_path);
  if (!options.channels.empty()) config.daemon.scan_channels = options.channels;
  if (options.threads > 0) config.tracker.threads = options.threads;
  ReplayResult result;
  {
    ProgressBar bar("odometry");
    result = replay_log(options.replay, config,
                        [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); });
  }
  if (!result.damage.empty()) std::cerr << "scanlock-odometry: " << result.damage << "\n";
  if (result.rejected > 0) {
    std::cerr << "scanlock-odometry: " << result.rejected
              << " messages hold no scan; the first: " << result.first_error << "\n";
  }
  if (result.scans == 0) {
    std::string names;
    for (const std::string& channel : config.daemon.scan_channels) names += " " + channel;
    throw std::runtime_error(options.replay.log_path + ": no scan on channel" + names +
                             "; `scanlock-convert LOG --info` lists the channels, --scan-channel chooses");
  }
  if (!options.tum_path.empty()) write_tum(options.tum_path, result.trajectory);
  if (!options.kitti_path.empty()) write_kitti(options.kitti_path, result.trajectory);
  const Json s = summary(result);
  if (options.json)
    std::cout << s.dump() << "\n";
  else
    print(s);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("LiDAR odometry over an LCM log: every scan, in order, as fast as the machine goes.",
               "scanlock-odometry");
  app.set_help_flag("-h,--help", "Print this help message and exit");
  app.set_version_flag("-V,--version", SCANLOCK_VERSION);
  app.add_option("LOG", options.replay.log_path, "LCM log with scans")->required();
  app.add_option("-c,--config", options.config_path, "Configuration (TOML), as scanlockd reads it");
  app.add_option("--scan-channel", options.channels,
                 "Channel of the scans; may be given again (default LIDAR)")
      ->allow_extra_args(false);
  app.add_option("--threads", options.threads, "Worker threads; the result does not depend on it")
      ->check(CLI::PositiveNumber);
  app.add_option("--poses", options.tum_path, "Write the trajectory (TUM)");
  app.add_option("--kitti", options.kitti_path, "Write the trajectory (KITTI)");
  app.add_option("--output", options.replay.output_log_path, "Write poses and odometry messages (LCM log)");
  app.add_option("--map", options.replay.map_path, "Write the map at the end (.ply)");
  app.add_flag("--json", options.json, "Print one JSON object on standard output");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::cerr << "scanlock-odometry: " << error.what() << "\n";
    return 1;
  }
}
