// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The common part of all conversions of scanlock-convert: the command line, warnings, and the result.
#pragma once

#include <array>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "daemon/config.hpp"
#include "io/progress_bar.hpp"
#include "io/scan_log.hpp"

namespace scanlock {

using Json = nlohmann::ordered_json;

/// Names of --type, in the order of ScanMessage.
constexpr std::array kScanMessages = {"pointcloud2", "pointcloud", "drake", "sectors", "planar"};

struct ConvertOptions {
  std::string input, output, merged, channel, type = "pointcloud2", format = "bin", up = "z";
  std::vector<double> offset = {0, 0, 0};  // metres
  std::optional<std::size_t> scan;
  ScanDirectory::Clock clock;
  bool info = false, json = false, force = false;
};

constexpr const char* kFooter = R"(IN and OUT select the conversion:
  DIR LOG                   numbered .bin, .pcd or .ply scans into an LCM log (channel LIDAR), in the order of their
                            numbers. DIR/times.txt (optional): a line for each scan with its stamp in seconds.
                            DIR/ptime/NAME.f32 (optional): float32 seconds of each point relative to that stamp.
  LOG DIR                   the reverse, into a new directory: .bin, times.txt, ptime/; with --format pcd or ply, NNNNNN.pcd or
                            .ply with a column `time`, and times.txt
  LOG OUT.pcd|OUT.ply|OUT.bin
                            one scan, selected by --scan if the log has several; in the sensor's frame, not deskewed
  LOG --info                channels, types, counts, rates, gaps; damaged parts are skipped, counted and reported
  SITE.ply|SITE.pcd SITE.map
                            a cloud from any program into a map for scanlockd --map, for a sensor at the body's origin, in
                            the cloud's frame, shifted by --offset and then rotated so that the axis --up becomes z. (--map
                            also takes the cloud itself; the .map loads faster.)
  SITE.map SITE.ply|SITE.pcd
                            the points of a map's keyframes as one cloud in the map frame, thinned to 5 cm; submaps that
                            are not joined to the first one are left out
  A.map B.map SITE.map      two overlapping maps, of drives with different starts and on different days, as one in the frame
                            of the first; exit 1 if no overlap is accepted. Submaps that are not joined to the first one of
                            their file are left out.
  LOG OUT.tum|OUT.kitti     a pose channel (POSE_BODY_CORRECTED) as a trajectory
  IN.tum OUT.kitti, IN.kitti OUT.tum
                            a trajectory in the other format: that of IN follows from its content, that of OUT from its name
                            (.tum: TUM; .kitti or .txt: KITTI)

Stamps: with times.txt, utime is that time in microseconds; without it (and for the poses of a KITTI file, which
has no times) scan n is stamped n periods after time zero. --utime sets the utime of time zero; the default is
1000000, or 0 if times.txt begins later than zero. The log's events carry the scans' own utime.)";

inline void declare_convert_options(CommandLine line, ConvertOptions& options) {
  line.explain(
      kFooter,
      {"scanlock-convert drive.lcmlog --info", "scanlock-convert drive.lcmlog scans --channel LIDAR",
       "scanlock-convert drive.lcmlog scans --format pcd", "scanlock-convert drive.lcmlog first.pcd --scan 0",
       "scanlock-convert site.ply site.map --offset 500000,5412000,0",
       "scanlock-convert poses.lcmlog poses.tum --channel POSE_BODY_CORRECTED"});
  line.option("IN", options.input, "a directory of scans, an LCM log or a trajectory").required();
  line.option("OUT", options.output, "an LCM log, a new directory, a cloud or a trajectory");
  line.option("SITE", options.merged, "the merged map, if IN and OUT are maps");
  line.option("--channel", options.channel,
              "channel of the scans (default: LIDAR) or poses (default: POSE_BODY_CORRECTED)")
      .channel();
  line.option("--type", options.type, "message type of the scans in a new log (default: pointcloud2)")
      .one_of({kScanMessages.begin(), kScanMessages.end()});
  line.option("--format", options.format,
              "file format of the scans in a new directory: bin, pcd or ply (default: bin)")
      .one_of({"bin", "pcd", "ply"});
  line.option("--scan", options.scan, "number of the scan that becomes the cloud OUT; the first is 0")
      .from_zero();
  line.option("--up", options.up, "the axis of a cloud SITE.ply or SITE.pcd that points upwards (default: z)")
      .one_of({kAxes.begin(), kAxes.end()});
  line.option("--offset", options.offset,
              "X,Y,Z in metres, subtracted from the coordinates of a cloud SITE.ply or SITE.pcd, for example "
              "in UTM; "
              "poses in the map are relative to it (default: 0,0,0)")
      .comma_separated(3);
  line.option("--period", options.clock.period_s,
              "seconds from scan to scan without times.txt (default: 0.1)")
      .above_zero();
  line.option("--utime", options.clock.zero_utime, "utime of time zero, microseconds").from_zero();
  line.flag("--info", options.info, "list the contents of the log IN");
  line.flag("--force", options.force, "overwrite outputs that are there already");
  line.flag("--json", options.json, "print one JSON object");
}

inline void warn(const ConvertOptions& options, const std::string& what) {
  std::cerr << "scanlock-convert: " << options.input << ": " << what << "\n";
}

/// Prints the result: one JSON object, or a line of `words` and the name of the output.
inline void report(const ConvertOptions& options, Json json, const std::string& words) {
  const std::string& output = options.merged.empty() ? options.output : options.merged;
  json["output"] = output;
  if (options.json)
    print_json(json);
  else
    print(words + " -> " + output + "\n");
}

}  // namespace scanlock
