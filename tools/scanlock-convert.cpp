// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Scans and trajectories between LCM logs and files.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "command_line.hpp"
#include "daemon/map_store.hpp"
#include "io/cloud_file.hpp"
#include "io/lcm_log.hpp"
#include "io/log_info.hpp"
#include "io/log_poses.hpp"
#include "io/map_file.hpp"
#include "io/output_files.hpp"
#include "io/progress_bar.hpp"
#include "io/scan_log.hpp"
#include "io/trajectory_source.hpp"
#include "mapping/cloud_map.hpp"
#include "mapping/map_merge.hpp"
#include "mapping/submap.hpp"

namespace {

using namespace scanlock;
using Json = nlohmann::ordered_json;

struct Options {
  std::string input, output, merged, channel, type = "pointcloud2", format = "bin";
  std::optional<std::size_t> scan;
  ScanDirectory::Clock clock;
  bool info = false, json = false, force = false;
};

constexpr const char* kFooter = R"(What is done depends on IN and OUT:
  DIR LOG                   numbered .bin, .pcd or .ply scans into an LCM log (channel LIDAR), in the order of their
                            numbers. DIR/times.txt, if there: a line for each scan, the seconds it is stamped with.
                            DIR/ptime/NAME.f32, if there: float32 seconds of each point relative to that stamp.
  LOG DIR                   the other way, into a new directory: .bin, times.txt, ptime/; with --format pcd or ply, NNNNNN.pcd or
                            .ply with a column `time`, and times.txt
  LOG OUT.pcd|OUT.ply|OUT.bin
                            one scan, which --scan names where the log has several; in the sensor's frame, not deskewed
  LOG --info                channels, types, counts, rates, gaps; damage is passed over, counted and reported
  SITE.ply|SITE.pcd SITE.map
                            a cloud of any program into a map for scanlockd --map, for a sensor at the body's origin; z
                            is up. (--map takes the cloud, too; the .map loads faster.)
  SITE.map SITE.ply|SITE.pcd
                            what the keyframes of a map have seen, as one cloud in its frame, thinned to 5 cm; submaps that
                            nothing ties to its frame are left out
  A.map B.map SITE.map      two maps with an overlap, of any two starts and days, as one in the frame of the first; exit 1 where
                            no overlap is believed. Submaps that nothing ties to the frame of their file are left out.
  LOG OUT.tum|OUT.kitti     a pose channel (POSE_BODY_CORRECTED) as a trajectory
  IN.tum OUT.kitti, IN.kitti OUT.tum
                            a trajectory in the other format; IN is told by its content, OUT by its name
                            (.tum: TUM; .kitti or .txt: KITTI)

Stamps: with times.txt, utime is that time in microseconds; without it (and for the poses of a KITTI file, which
has no times) scan n is stamped n periods after zero. --utime moves zero to US; by default zero is utime 1000000,
and 0 when times.txt begins later than zero. The log's events carry the scans' own utime.)";

void declare(CommandLine line, Options& options) {
  line.explain(
      kFooter,
      {"scanlock-convert drive.lcmlog --info", "scanlock-convert drive.lcmlog scans --channel LIDAR",
       "scanlock-convert drive.lcmlog scans --format pcd", "scanlock-convert drive.lcmlog first.pcd --scan 0",
       "scanlock-convert poses.lcmlog poses.tum --channel POSE_BODY_CORRECTED"});
  line.option("IN", options.input, "a directory of scans, an LCM log or a trajectory").required();
  line.option("OUT", options.output, "an LCM log, a new directory, a cloud or a trajectory");
  line.option("SITE", options.merged, "the map that the maps IN and OUT become");
  line.option("--channel", options.channel, "of the scans (default: LIDAR) or poses (POSE_BODY_CORRECTED)")
      .channel();
  line.option("--type", options.type, "message type of the scans in a new log (default: pointcloud2)")
      .one_of({"pointcloud2", "pointcloud", "drake", "sectors", "planar"});
  line.option("--format", options.format, "of the scans in a new directory: bin, pcd or ply (default: bin)")
      .one_of({"bin", "pcd", "ply"});
  line.option("--scan", options.scan, "the number of the scan for a cloud OUT, from 0 on").from_zero();
  line.option("--period", options.clock.period_s,
              "seconds from scan to scan without times.txt (default: 0.1)")
      .above_zero();
  line.option("--utime", options.clock.zero_utime, "microseconds: the utime of time zero").from_zero();
  line.flag("--info", options.info, "tell what is in the log IN");
  line.flag("--force", options.force, "overwrite an OUT that is there already");
  line.flag("--json", options.json, "print one JSON object");
}

void warn(const Options& options, const std::string& what) {
  std::cerr << "scanlock-convert: " << options.input << ": " << what << "\n";
}

std::string channel_or(const Options& options, const char* standard) {
  return options.channel.empty() ? standard : options.channel;
}

Progress shown_by(ProgressBar& bar) {
  return [&bar](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
}

void report_scans(const Options& options, const ScanConversion& result, const std::string& channel) {
  if (result.rejected > 0)
    warn(options, std::to_string(result.rejected) + " messages on " + channel + " hold no scan (" +
                      result.first_error + ")");
  if (result.incomplete > 0)
    warn(options, std::to_string(result.incomplete) + " scans lack some of their sectors");
  if (!result.damage.empty()) warn(options, result.damage);
  if (options.json)
    print_json(Json{{"scans", result.scans},
                    {"points", result.points},
                    {"left_out_points", result.left_out_points},
                    {"rejected", result.rejected},
                    {"incomplete", result.incomplete},
                    {"channel", channel},
                    {"output", options.output}});
  else
    std::cout << result.scans << " scans, " << result.points << " points, channel " << channel << " -> "
              << options.output << "\n";
}

void convert_directory(const Options& options) {
  static const std::map<std::string, ScanMessage> types = {{"pointcloud2", ScanMessage::kPointcloud2},
                                                           {"pointcloud", ScanMessage::kPointcloud},
                                                           {"drake", ScanMessage::kDrake},
                                                           {"sectors", ScanMessage::kSectors},
                                                           {"planar", ScanMessage::kPlanar}};
  const std::string channel = channel_or(options, "LIDAR");
  ProgressBar bar("scans");
  report_scans(options,
               directory_to_log(ScanDirectory(options.input, options.clock), options.output, channel,
                                types.at(options.type), shown_by(bar)),
               channel);
}

void convert_log_scans(const Options& options) {
  const std::string channel = channel_or(options, "LIDAR");
  ProgressBar bar("log");
  report_scans(options,
               log_to_directory(options.input, channel, options.output, shown_by(bar), options.force,
                                "." + options.format),
               channel);
}

void convert_log_scan(const Options& options) {
  const std::string channel = channel_or(options, "LIDAR");
  ProgressBar bar("log");
  report_scans(options, log_to_cloud(options.input, channel, options.output, options.scan, shown_by(bar)),
               channel);
}

Json info_json(const Options& options, const LogInfo& info) {
  Json channels = Json::array();
  for (const ChannelInfo& c : info.channels)
    channels.push_back({{"name", c.name},
                        {"type", c.type},
                        {"events", c.events},
                        {"bytes", c.bytes},
                        {"first_utime", c.first_utime},
                        {"last_utime", c.last_utime},
                        {"rate_hz", c.rate_hz},
                        {"gaps", c.gaps},
                        {"largest_gap_s", c.largest_gap_s},
                        {"backward_steps", c.backward_steps}});
  return {{"file", options.input},
          {"events", info.events},
          {"duration_s", info.duration_s},
          {"damaged_places", info.damaged_places},
          {"skipped_bytes", info.skipped_bytes},
          {"truncated", info.truncated},
          {"channels", channels}};
}

void show_info(const Options& options) {
  check_log(options.input);
  LogInfo info;
  {
    ProgressBar bar("log");
    info = inspect_log(options.input, shown_by(bar));
  }
  if (options.json) {
    print_json(info_json(options, info));
    return;
  }
  std::printf("%s: %zu events, %.3f s\n", options.input.c_str(), info.events, info.duration_s);
  if (info.damaged_places > 0)
    std::printf("DAMAGED at %lld place(s), %lld bytes skipped\n", static_cast<long long>(info.damaged_places),
                static_cast<long long>(info.skipped_bytes));
  if (info.truncated) std::printf("TRUNCATED: the last event is cut short\n");
  if (info.channels.empty()) return;
  std::printf("%-28s %8s %10s %9s %6s %9s  %s\n", "channel", "events", "MB", "rate Hz", "gaps", "longest s",
              "type");
  for (const ChannelInfo& c : info.channels) {
    std::printf("%-28s %8zu %10.3f %9.2f %6zu %9.3f  %s\n", c.name.c_str(), c.events,
                static_cast<double>(c.bytes) * 1e-6, c.rate_hz, c.gaps, c.largest_gap_s, c.type.c_str());
    if (c.backward_steps > 0)
      std::printf("%-28s %zu events are stamped before the one in front\n", "", c.backward_steps);
  }
}

/// KITTI poses have no times: they get those of scans without times.txt.
void stamp(Trajectory& trajectory, const ScanDirectory::Clock& clock) {
  const double zero_s = clock.zero_utime >= 0 ? static_cast<double>(clock.zero_utime) * 1e-6 : 1.0;
  for (StampedPose& stamped : trajectory) stamped.time_s = zero_s + clock.period_s * stamped.time_s;
}

void convert_trajectory(const Options& options) {
  const bool log = is_log(options.input);
  const std::string source =
      log && !options.channel.empty() ? options.input + ":" + options.channel : options.input;
  LoadedTrajectory loaded = load_trajectory(source);
  if (!loaded.warning.empty()) warn(options, loaded.warning);
  const bool to_tum = std::filesystem::path(options.output).extension() == ".tum";
  if (to_tum) {
    if (!loaded.has_times) stamp(loaded.trajectory, options.clock);
    write_tum(options.output, loaded.trajectory);
  } else {
    write_kitti(options.output, loaded.trajectory);
  }
  if (options.json)
    print_json(Json{{"poses", loaded.trajectory.size()}, {"output", options.output}});
  else
    std::cout << loaded.trajectory.size() << " poses -> " << options.output << "\n";
}

/// One of the two is a map, the other a cloud.
void convert_map(const Options& options) {
  constexpr float kVoxel = 0.05F;  // metres
  SavedMap map;
  std::size_t points = 0;
  if (is_bare_cloud(options.input)) {
    CloudMapOptions how;
    how.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    CloudMapBuilder builder(how);
    {
      ProgressBar bar("points");
      const auto take = [&](PointCloud&& part) {
        points += part.size();
        builder.add(std::move(part));
      };
      read_cloud(options.input, take, shown_by(bar));
    }
    ProgressBar bar("map");
    map = builder.build(options.input, shown_by(bar));
    if (!builder.doubt().empty()) warn(options, builder.doubt());
    write_map(options.output, map);
  } else {
    const SavedMap all = read_map(options.input);
    map = first_submap(all);
    if (const std::size_t others = all.keyframes.size() - map.keyframes.size(); others > 0)
      std::cerr << options.input << ": " << others
                << " keyframes of submaps that nothing ties to the first one "
                << "are left out\n";
    const PointCloud cloud = cloud_of_map(map, kVoxel);
    write_cloud(options.output, cloud);
    points = cloud.size();
  }
  if (options.json)
    print_json(Json{{"keyframes", map.keyframes.size()}, {"points", points}, {"output", options.output}});
  else
    std::cout << map.keyframes.size() << " keyframes, " << points << " points -> " << options.output << "\n";
}

void merge(const Options& options) {
  const SavedMap first = read_map(options.input), second = read_map(options.output);
  MapMerge merged;
  {
    ProgressBar bar("overlap");
    merged = merge_maps(first, second, {}, shown_by(bar));
  }
  if (!merged.joined) {
    const std::string others =
        merged.otherwise > 1 ? ", and " + std::to_string(merged.otherwise) + " on another one" : "";
    throw std::runtime_error(
        options.output + ": no overlap with " + options.input + " is believed, and no map is written: of " +
        std::to_string(merged.searches) + " keyframes that were looked for " + std::to_string(merged.found) +
        " were found, and " + std::to_string(merged.agreeing) + " of them agree on an overlap" + others);
  }
  write_map(options.merged, merged.map);
  if (options.json)
    print_json(Json{{"keyframes", merged.map.keyframes.size()},
                    {"searches", merged.searches},
                    {"found", merged.found},
                    {"agreeing", merged.agreeing},
                    {"closures", merged.closures},
                    {"output", options.merged}});
  else
    std::cout << merged.map.keyframes.size() << " keyframes, " << merged.closures
              << " loop closures between the two -> " << options.merged << "\n";
}

/// The kind of output follows from IN; a name that says another was not meant so.
void check_kind(const Options& options, bool from_directory, bool to_directory) {
  const std::string &input = options.input, &output = options.output;
  const std::string extension = std::filesystem::path(output).extension().string();
  const auto is_one_of = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), extension) != names.end();
  };
  if (from_directory && is_one_of({".tum", ".kitti", ".txt", ".bin", ".ply", ".pcd"}))
    throw std::runtime_error(input + ": is a directory, whose scans go into a .lcmlog, not into " + output);
  if (to_directory && is_one_of({".lcmlog", ".xyz"}))
    throw std::runtime_error(input + ": is a log, whose scans go into a directory or a .pcd, .ply or .bin, " +
                             "and poses into a .tum or .kitti, not into " + output);
}

void run(const Options& options) {
  namespace fs = std::filesystem;
  if (options.info && !options.output.empty()) throw UsageError("--info takes no OUT");
  if (!options.info && options.output.empty()) throw UsageError("OUT is missing (or --info)");
  if (!options.merged.empty())
    for (const std::string& map : {options.input, options.output, options.merged})
      if (fs::path(map).extension() != ".map")
        throw UsageError("three files are two maps and the one that they become, each a .map: " + map);
  std::error_code error;
  if (!fs::exists(options.input, error))
    throw std::runtime_error(options.input + ": " + (error ? error.message() : "no such file or directory"));
  if (options.info) return show_info(options);
  if (!options.merged.empty()) {
    check_outputs({{options.input, options.output}, {options.merged}, ""}, options.force);
    return merge(options);
  }
  const bool directory = fs::is_directory(options.input), log = !directory && is_log(options.input);
  const fs::path extension = fs::path(options.output).extension();
  const bool to_trajectory = extension == ".tum" || extension == ".kitti" || extension == ".txt";
  const fs::path input = options.input, output = options.output;
  if (!directory && !log &&
      ((is_bare_cloud(input) && extension == ".map") ||
       (input.extension() == ".map" && is_bare_cloud(output)))) {
    check_outputs({{options.input}, {options.output}, ""}, options.force);
    return convert_map(options);
  }
  if (!directory && !log && !to_trajectory)
    throw std::runtime_error(options.output + ": name a trajectory .tum, .kitti or .txt (" + options.input +
                             " is neither a directory nor an LCM log)");
  const bool to_cloud = log && (extension == ".pcd" || extension == ".ply" || extension == ".bin");
  if (options.scan && !to_cloud)
    throw UsageError("--scan goes with a log and a cloud OUT (.pcd, .ply or .bin)");
  const bool to_directory = log && !to_trajectory && !to_cloud;
  check_outputs({{options.input}, {to_directory ? "" : options.output}, to_directory ? options.output : ""},
                options.force);
  check_kind(options, directory, to_directory);
  if (directory) return convert_directory(options);
  if (to_cloud) return convert_log_scan(options);
  to_directory ? convert_log_scans(options) : convert_trajectory(options);
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<Options>("scanlock-convert", "Scans and trajectories between LCM logs and files.", argc,
                              argv, declare, [](const Options& options) {
                                run(options);
                                return 0;
                              });
}
