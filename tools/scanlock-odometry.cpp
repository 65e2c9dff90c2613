// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "command_line.hpp"
#include "daemon/config.hpp"
#include "daemon/replay.hpp"
#include "daemon/statistics.hpp"
#include "evaluation/map_picture.hpp"
#include "io/cloud_file.hpp"
#include "io/file_bytes.hpp"
#include "io/map_file.hpp"
#include "io/output_files.hpp"
#include "io/progress_bar.hpp"
#include "io/trajectory.hpp"

namespace {

using namespace scanlock;
using Json = nlohmann::ordered_json;

struct Options {
  std::string log_path, output_path, map_path, start_map_path, config_path, tum_path, kitti_path,
      picture_path;
  std::vector<std::string> channels;
  int threads = 0;
  bool json = false, force = false;
};

/// The result of a replay.
struct Result {
  Trajectory trajectory;                             // the pose of each scan, also where it is only predicted
  std::vector<std::optional<std::uint32_t>> stamps;  // of the poses in `trajectory`, see PoseHistory
  std::array<std::int64_t, 6> states{};
  std::int64_t recoveries = 0, loop_closures = 0, false_starts = 0;
  double distance_m = 0;
  // Seconds from the first scan to the first pose in a map, loaded or its own.
  std::optional<double> found_after_s;
  std::vector<double> scan_ms;  // wall time of each scan
  /// Pieces of the trajectory without a jump, in which the pose in the map is known.
  // Indices of the first pose, and of the pose after the last.
  std::vector<std::pair<std::size_t, std::size_t>> pieces;
  std::vector<std::pair<std::size_t, std::string>> corrections;  // index of the pose, and the reason

  void note(const FinishedScan& finished, double ms) {
    const TrackedScan& tracked = finished.tracked;
    scan_ms.push_back(ms);
    if (tracked.verdict != ScanVerdict::kTracked && tracked.method == PoseMethod::kNone) return;
    ++states[static_cast<std::size_t>(tracked.state)];
    const bool corrected = tracked.recovery && tracked.recovery->accepted;
    recoveries += corrected && !tracked.recovery->loop_closure ? 1 : 0;
    loop_closures = tracked.loop_closures;
    if (tracked.epoch != epoch_ && !corrected) ++false_starts;
    if (!trajectory.empty() && tracked.epoch == epoch_)
      distance_m += (tracked.map_from_body.translation() - trajectory.back().pose.translation()).norm();
    epoch_ = tracked.epoch;
    trajectory.push_back({static_cast<double>(tracked.utime) * 1e-6, tracked.map_from_body});
    stamps.push_back(tracked.stamp);
    if (!tracked.localised) return;
    if (!found_after_s) found_after_s = trajectory.back().time_s - trajectory.front().time_s;
    if (corrected) corrections.emplace_back(trajectory.size() - 1, tracked.recovery->reason);
    const bool known = tracked.state == TrackingState::kTracking || tracked.state == TrackingState::kDegraded;
    if (!known) return;
    if (pieces.empty() || corrected || pieces.back().second + 1 != trajectory.size())
      pieces.emplace_back(trajectory.size() - 1, trajectory.size());
    pieces.back().second = trajectory.size();
  }

  /// Corrects the poses by the map as it is at the end.
  void settle(const Pipeline& pipeline) {
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      if (stamps[i]) trajectory[i].pose = pipeline.correction(*stamps[i]) * trajectory[i].pose;
    }
  }

 private:
  std::uint32_t epoch_ = 0;
};

constexpr float kPictureVoxel = 0.1F;  // metres

MapPicture picture_of(const Result& result, const Pipeline& pipeline, const Options& options) {
  MapPicture picture;
  const bool given = !options.start_map_path.empty();
  picture.map = pipeline.archived(kPictureVoxel, given ? Pipeline::Part::kFirst : Pipeline::Part::kAll);
  picture.title = std::filesystem::path(options.log_path).filename().string();
  if (given)
    picture.title += (result.found_after_s ? " in " : ", not found in ") +
                     std::filesystem::path(options.start_map_path).filename().string();
  const auto position = [&](std::size_t i) {
    return Eigen::Vector3d(result.trajectory[i].pose.translation());
  };
  for (const auto& [begin, end] : result.pieces) {
    picture.ways.emplace_back();
    for (std::size_t i = begin; i < end; ++i) picture.ways.back().push_back(position(i));
  }
  for (const auto& [pose, why] : result.corrections)
    picture.corrections.push_back(
        {position(pose), result.trajectory[pose].time_s - result.trajectory.front().time_s, why});
  return picture;
}

/// The sink for a replay without output of messages.
class NoSink final : public MessageSink {
 public:
  void send(std::int64_t, const std::string&, const Bytes&) override {}
};

Json summary(const Result& result, const Counters& counters) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  const std::vector<double>& ms = result.scan_ms;
  const double sum = std::accumulate(ms.begin(), ms.end(), 0.0);
  const auto state = [&](TrackingState s) { return result.states[static_cast<std::size_t>(s)]; };
  return {{"scans", counters.received},
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
          {"loop_closures", result.loop_closures},
          {"false_starts", result.false_starts},
          {"used", counters.used},
          {"rejected", counters.rejected()},
          {"rejected_clock", counters.clock},
          {"clock_steps", counters.clock_steps},
          {"ms",
           {{"p50", percentile(ms, 0.5)},
            {"p95", percentile(ms, 0.95)},
            {"p99", percentile(ms, 0.99)},
            {"max", percentile(ms, 1.0)},
            {"mean", ms.empty() ? 0.0 : sum / static_cast<double>(ms.size())}}},
          {"cpu_s", seconds(usage.ru_utime) + seconds(usage.ru_stime)},
          {"peak_rss_mb", peak_rss_mb()}};
}

void print(const Json& s) {
  const auto count = [](const Json& value) { return value.get<long long>(); };
  const auto real = [](const Json& value) { return value.get<double>(); };
  const Json &states = s["states"], &ms = s["ms"];
  std::printf("%-16s %lld, poses %lld, way %.1f m\n", "scans", count(s["scans"]), count(s["poses"]),
              real(s["distance_m"]));
  std::printf(
      "%-16s tracking %lld, degraded %lld, recovering %lld, ambiguous %lld, lost %lld, initialising %lld\n",
      "states", count(states["tracking"]), count(states["degraded"]), count(states["recovering"]),
      count(states["ambiguous"]), count(states["lost"]), count(states["initialising"]));
  if (s.contains("found_after_s") && !s["found_after_s"].is_null())
    std::printf("%-16s after %.1f s in the map\n", "found", real(s["found_after_s"]));
  std::printf("%-16s p50 %.1f ms, p95 %.1f ms, p99 %.1f ms, max %.1f ms\n", "time of a scan", real(ms["p50"]),
              real(ms["p95"]), real(ms["p99"]), real(ms["max"]));
  std::printf("%-16s CPU %.1f s, peak memory %.0f MB\n", "whole run", real(s["cpu_s"]),
              real(s["peak_rss_mb"]));
}

/// Prints the faults of the log: for each kind the number and the first message.
void print_faults(const Statistics& statistics) {
  const Counters counters = statistics.report().counters;
  const std::pair<std::int64_t Counters::*, const char*> kFaults[] = {
      {&Counters::truncated, "messages rejected"},
      {&Counters::unknown_type, "messages rejected"},
      {&Counters::bad_size, "messages rejected"},
      {&Counters::bad_field, "messages rejected"},
      {&Counters::empty, "scans rejected"},
      {&Counters::duplicate_time, "scans rejected"},
      {&Counters::backward_time, "scans rejected"},
      {&Counters::clock, "scans rejected"},
      {&Counters::clock_steps, "steps of the clock"},
      {&Counters::two_publishers, "signs of two publishers"},
      {&Counters::map_faults, "faults of the map"},
      {&Counters::without_time, "scans without a stamp"},
      {&Counters::without_point_times, "scans without times of points"},
      {&Counters::incomplete, "scans incomplete"},
      {&Counters::sectors_discarded, "sectors discarded"},
      {&Counters::priors_rejected, "faults of the priors"},
      {&Counters::priors_absent, "faults of the priors"},
      {&Counters::priors_contradicting, "faults of the priors"},
      {&Counters::commands_rejected, "commands rejected"}};
  for (const auto& [counter, words] : kFaults) {
    const std::string first = statistics.first_complaint(counter);
    if (!first.empty())
      std::cerr << "scanlock-odometry: " << counters.*counter << " " << words << "; the first: " << first
                << "\n";
  }
}

Config configured(const Options& options) {
  Config config = options.config_path.empty() ? Config{} : load_config(options.config_path);
  if (!options.channels.empty()) config.daemon.scan_channels = options.channels;
  if (options.threads > 0) config.tracker.threads = options.threads;
  config.daemon.map.file = options.start_map_path;  // the map file is only read: a replay does not save
  check_config(config);
  return config;
}

int run(const Options& options) {
  check_outputs(
      {{options.log_path, options.config_path, options.start_map_path},
       {options.tum_path, options.kitti_path, options.output_path, options.map_path, options.picture_path},
       ""},
      options.force);
  const bool to_map_file = has_extension(options.map_path, {".map"});
  if (to_map_file)
    check_map_path(options.map_path);
  else if (!options.map_path.empty())
    check_cloud_path(options.map_path);
  check_picture_path(options.picture_path);
  if (!options.start_map_path.empty() && !std::filesystem::exists(options.start_map_path))
    throw std::runtime_error(options.start_map_path + ": no such file or directory");
  check_log(options.log_path);
  const Config config = configured(options);
  Statistics statistics([](LogLevel, const std::string&) {});
  std::unique_ptr<MessageSink> sink = std::make_unique<NoSink>();
  if (!options.output_path.empty())
    sink = std::make_unique<LogSink>(options.output_path, LogWriter::Mode::kCreate);
  Pipeline pipeline(config, statistics, Pipeline::Mode::kReplay);
  pipeline.keep_history();
  Replay replay({options.log_path, 0, 0}, config, SCANLOCK_VERSION, pipeline, statistics, *sink);
  Result result;
  {
    ProgressBar bar("odometry");
    replay.run(
        StopSignal(), [&](const FinishedScan& finished, double ms) { result.note(finished, ms); },
        bar.updater());
  }
  sink->close();
  const std::string why = replay.why_no_scan(), damage = replay.damage();
  if (!why.empty()) throw std::runtime_error(why + (damage.empty() ? "" : " (" + damage + ")"));
  if (to_map_file)
    write_map(options.map_path, pipeline.saved_map());
  else if (!options.map_path.empty())
    write_cloud(options.map_path, pipeline.map());
  result.settle(pipeline);
  if (!options.tum_path.empty()) write_tum(options.tum_path, result.trajectory);
  if (!options.kitti_path.empty()) write_kitti(options.kitti_path, result.trajectory);
  if (!options.picture_path.empty())
    write_file_bytes(options.picture_path, map_svg(picture_of(result, pipeline, options)));
  if (!damage.empty()) std::cerr << "scanlock-odometry: " << damage << "\n";
  print_faults(statistics);
  Json s = summary(result, statistics.report().counters);
  if (!options.start_map_path.empty()) {
    s["found_after_s"] = result.found_after_s ? Json(*result.found_after_s) : Json();
    if (!result.found_after_s)
      std::cerr << "scanlock-odometry: the robot's pose was not found in " << options.start_map_path
                << ": the poses are in a frame of the log's own\n";
  }
  if (options.json)
    print_json(s);
  else
    print(s);
  return 0;
}

void declare(CommandLine line, Options& options) {
  line.explain("", {"scanlock-odometry drive.lcmlog --poses poses.tum --map map.ply",
                    "scanlock-odometry drive.lcmlog --start-map site.ply --output poses.lcmlog --json",
                    "scanlock-odometry drive.lcmlog --start-map site.ply --picture found.svg"});
  line.option("LOG", options.log_path, "LCM log with scans").required();
  line.option("-c,--config", options.config_path, "configuration (TOML), as scanlockd reads it");
  line.option("--scan-channel", options.channels, "channel of the scans; may be repeated (default: LIDAR)")
      .repeated();
  line.option("--threads", options.threads, "worker threads; the result does not depend on it")
      .within(1, 256);
  line.option("--poses", options.tum_path,
              "write the trajectory (TUM), as loop closures leave it at the end");
  line.option("--kitti", options.kitti_path, "write the trajectory (KITTI), likewise");
  line.option("--output", options.output_path,
              "write poses and odometry messages (LCM log), as they were at the time");
  line.option("--start-map", options.start_map_path,
              "map to relocalise in (.map, .ply, .pcd), as scanlockd --map; it is not written. Until it is "
              "found, if ever, poses are in a frame of the log's own (JSON: found_after_s, or null)");
  line.option("--map", options.map_path,
              "write the map at the end: a map file (.map), or the surroundings of the robot as a cloud "
              "(.ply, .pcd)");
  line.option(
      "--picture", options.picture_path,
      "draw the map from above, the path in it, and place, time and evidence of the relocalisation (.svg)");
  line.flag("--force", options.force, "overwrite outputs that are there already");
  line.flag("--json", options.json, "print one JSON object on standard output");
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<Options>(
      "scanlock-odometry",
      "LiDAR odometry over an LCM log: every scan, in order, as fast as the machine goes.", argc, argv,
      declare, run);
}
