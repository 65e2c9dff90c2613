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
                            a cloud of any program into a map for scanlockd --map, for a sensor at the body's origin, in
                            the cloud's frame; moved with --offset, and then turned with --up so that z is up. (--map takes
                            the cloud, too; the .map loads faster.)
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

inline void declare_convert_options(CommandLine line, ConvertOptions& options) {
  line.explain(
      kFooter,
      {"scanlock-convert drive.lcmlog --info", "scanlock-convert drive.lcmlog scans --channel LIDAR",
       "scanlock-convert drive.lcmlog scans --format pcd", "scanlock-convert drive.lcmlog first.pcd --scan 0",
       "scanlock-convert site.ply site.map --offset 500000,5412000,0",
       "scanlock-convert poses.lcmlog poses.tum --channel POSE_BODY_CORRECTED"});
  line.option("IN", options.input, "a directory of scans, an LCM log or a trajectory").required();
  line.option("OUT", options.output, "an LCM log, a new directory, a cloud or a trajectory");
  line.option("SITE", options.merged, "the map that the maps IN and OUT become");
  line.option("--channel", options.channel, "of the scans (default: LIDAR) or poses (POSE_BODY_CORRECTED)")
      .channel();
  line.option("--type", options.type, "message type of the scans in a new log (default: pointcloud2)")
      .one_of({kScanMessages.begin(), kScanMessages.end()});
  line.option("--format", options.format, "of the scans in a new directory: bin, pcd or ply (default: bin)")
      .one_of({"bin", "pcd", "ply"});
  line.option("--scan", options.scan, "the number of the scan for a cloud OUT, from 0 on").from_zero();
  line.option("--up", options.up, "the axis of a cloud SITE.ply or SITE.pcd that points upwards (default: z)")
      .one_of({kAxes.begin(), kAxes.end()});
  line.option(
          "--offset", options.offset,
          "metres, X,Y,Z: subtracted from the coordinates of a cloud SITE.ply or SITE.pcd, as of one in UTM; "
          "poses are relative to it (default: 0,0,0)")
      .comma_separated(3);
  line.option("--period", options.clock.period_s,
              "seconds from scan to scan without times.txt (default: 0.1)")
      .above_zero();
  line.option("--utime", options.clock.zero_utime, "microseconds: the utime of time zero").from_zero();
  line.flag("--info", options.info, "tell what is in the log IN");
  line.flag("--force", options.force, "overwrite an OUT that is there already");
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
