// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-simulate: drives a simulated LiDAR through a world into an LCM log, with exact truth.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "io/lcm_log.hpp"
#include "io/trajectory.hpp"
#include "messages/encode_scan.hpp"
#include "simulation/simulator.hpp"

namespace {

using namespace scanlock;

struct Options {
  std::string world = "urban", lidar = "vlp16", stamp = "begin", channel = "LIDAR";
  std::vector<std::string> events;
  std::string log, truth, bin;
  double noise = -1;
  bool no_distortion = false, json = false;
  SimulationConfig config;
};

void declare(CLI::App& app, Options& options) {
  app.set_version_flag("-V,--version", SCANLOCK_VERSION);
  app.add_option("--world", options.world, "urban, indoor, forest, tunnel or field")->capture_default_str();
  app.add_option("--lidar", options.lidar, "vlp16, hdl64, os1-64, mid360 or planar")->capture_default_str();
  app.add_option("--seconds", options.config.seconds, "Length of the drive")->capture_default_str();
  app.add_option("--seed", options.config.seed, "World, route and noise follow from it")
      ->capture_default_str();
  app.add_option(
         "--event", options.events,
         "May be given again; in seconds: kidnap@T (the sensor is carried 3 to 15 m and turned), "
         "blackout@T+D "
         "(scans empty or of at most 20 points), shake@T+D (strong rotations), halfview@T+D (nothing seen to "
         "the left), dropout@T+D (scans missing altogether)")
      ->allow_extra_args(false);  // one event each: the word that follows may be the log
  app.add_option("--speed", options.config.speed_mps, "Cruising speed in m/s instead of the world's own");
  app.add_option("--noise", options.noise,
                 "Standard deviation of ranges in metres instead of the sensor's own")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--no-distortion", options.no_distortion, "Take all points of a scan at its stamp");
  app.add_option("--stamp", options.stamp, "Stamp the begin or the end of each sweep")
      ->check(CLI::IsMember({"begin", "end"}))
      ->capture_default_str();
  app.add_option("--channel", options.channel, "Channel of the scans")->capture_default_str();
  app.add_option("--truth", options.truth, "Also write the sensor's exact pose at each scan's stamp (TUM)");
  app.add_option(
      "--bin", options.bin,
      "Also write the scans to this directory: NNNNNN.bin (KITTI), ptime/NNNNNN.f32 and times.txt, as "
      "scanlock-convert reads them");
  app.add_option("--threads", options.config.threads, "The result does not depend on it")
      ->capture_default_str();
  app.add_flag("--json", options.json, "Print one JSON object on standard output");
  app.add_option("LOG", options.log, "The LCM log to write")->required();
}

/// What the words on the command line mean; throws std::invalid_argument.
void settle(Options& options) {
  options.config.world = parse_world(options.world);
  options.config.lidar = parse_lidar(options.lidar);
  for (const std::string& text : options.events) options.config.events.push_back(parse_event(text));
  if (options.noise >= 0) options.config.noise_m = options.noise;
  options.config.motion_distortion = !options.no_distortion;
  options.config.stamp_at_end = options.stamp == "end";
}

/// A bar on standard error for a person who waits; nothing when it is no terminal.
class Progress {
 public:
  explicit Progress(std::int64_t total) : total_(std::max<std::int64_t>(1, total)) {}
  ~Progress() {
    if (drawn_) std::fprintf(stderr, "\n");
  }
  void show(std::int64_t done) {
    const auto now = std::chrono::steady_clock::now();
    if (!isatty(STDERR_FILENO) || now - begin_ < std::chrono::seconds(2)) return;
    if (drawn_ && now - shown_ < std::chrono::milliseconds(200)) return;
    shown_ = now;
    drawn_ = true;
    const auto filled = static_cast<std::size_t>(40 * done / total_);
    const std::string bar = std::string(filled, '#') + std::string(40 - filled, '.');
    std::fprintf(stderr, "\r[%s] %lld of %lld scans", bar.c_str(), static_cast<long long>(done),
                 static_cast<long long>(total_));
  }

 private:
  std::int64_t total_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now(), shown_ = begin_;
  bool drawn_ = false;
};

/// Numbered scans as the KITTI benchmark keeps them, for programs that read no log.
class ScanDirectory {
 public:
  explicit ScanDirectory(const std::string& path) : path_(path) {
    std::filesystem::create_directories(path_ / "ptime");
    times_.open(path_ / "times.txt");
  }
  void write(const SimulatedScan& simulated) {
    char name[32];
    std::snprintf(name, sizeof name, "%06d", number_++);
    const PointCloud& points = simulated.scan.points;
    std::vector<float> values;
    values.reserve(4 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      values.insert(values.end(), {points.x[i], points.y[i], points.z[i], points.intensity[i] / 255});
    save(path_ / (std::string(name) + ".bin"), values);
    save(path_ / "ptime" / (std::string(name) + ".f32"), points.time);
    char line[64];
    std::snprintf(line, sizeof line, "%.6f\n", static_cast<double>(simulated.scan.utime) * 1e-6);
    times_ << line << std::flush;
    if (!times_) throw std::runtime_error((path_ / "times.txt").string() + ": cannot be written");
  }

 private:
  static void save(const std::filesystem::path& path, const std::vector<float>& values) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(float)));
    file.close();
    if (!file) throw std::runtime_error(path.string() + ": cannot be written, is the disk full?");
  }
  std::filesystem::path path_;
  std::ofstream times_;
  int number_ = 0;
};

struct Summary {
  std::int64_t scans = 0, points = 0;
  double distance_m = 0, elapsed_s = 0;
};

Summary run(const Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  Simulator simulator(options.config);
  LogWriter log(options.log);
  if (!options.truth.empty())
    write_tum(options.truth, {});  // a path that cannot be written fails now, not at the end
  std::optional<ScanDirectory> directory;
  if (!options.bin.empty()) directory.emplace(options.bin);
  Progress progress(simulator.sweeps());
  Trajectory truth;
  Summary summary;
  while (const auto simulated = simulator.next()) {
    ScanTags tags;
    tags.seq = static_cast<std::int32_t>(simulator.position() - 1);
    log.write(simulated->scan.utime, options.channel, encode_pointcloud2(simulated->scan, tags));
    if (directory) directory->write(*simulated);
    if (!truth.empty())
      summary.distance_m +=
          (simulated->world_from_body.translation() - truth.back().pose.translation()).norm();
    truth.push_back({static_cast<double>(simulated->scan.utime) * 1e-6, simulated->world_from_body});
    ++summary.scans;
    summary.points += static_cast<std::int64_t>(simulated->scan.points.size());
    progress.show(simulator.position());
  }
  log.close();
  if (!options.truth.empty()) write_tum(options.truth, truth);
  summary.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

void report(const Options& options, const Summary& summary) {
  if (options.json) {
    const nlohmann::ordered_json json = {{"scans", summary.scans},
                                         {"points", summary.points},
                                         {"distance_m", summary.distance_m},
                                         {"elapsed_s", summary.elapsed_s}};
    std::cout << json.dump() << "\n";
  } else {
    std::printf("%s: %lld scans, %lld points, %.1f m driven (%s, %s), made in %.1f s\n", options.log.c_str(),
                static_cast<long long>(summary.scans), static_cast<long long>(summary.points),
                summary.distance_m, options.world.c_str(), options.lidar.c_str(), summary.elapsed_s);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Drives a simulated LiDAR through a world into an LCM log, with exact truth.",
               "scanlock-simulate");
  Options options;
  options.config.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  declare(app, options);
  try {
    app.parse(argc, argv);
    settle(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "scanlock-simulate: %s\n", error.what());
    return 2;
  }
  try {
    report(options, run(options));
    return 0;
  } catch (const std::invalid_argument& error) {  // what the configuration asks for cannot be
    std::fprintf(stderr, "scanlock-simulate: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scanlock-simulate: %s\n", error.what());
    return 1;
  }
}
