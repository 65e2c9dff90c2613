// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-convert: converts scans, maps and trajectories between LCM logs and files. The names of the files
// decide which conversion it is.
#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "convert_info.hpp"
#include "convert_maps.hpp"
#include "convert_options.hpp"
#include "convert_scans.hpp"
#include "convert_trajectory.hpp"
#include "io/log_poses.hpp"
#include "io/output_files.hpp"

namespace {

using namespace scanlock;

void check_usage(const ConvertOptions& options) {
  if (!Eigen::Vector3d(options.offset.data()).allFinite()) throw UsageError("--offset must be finite");
  if (options.info && !options.output.empty()) throw UsageError("--info takes no OUT");
  if (!options.info && options.output.empty()) throw UsageError("OUT is missing (or --info)");
  if (options.merged.empty()) return;
  for (const std::string& map : {options.input, options.output, options.merged})
    if (!has_extension(map, {".map"}))
      throw UsageError("three files must be two maps and their merged map, each a .map: " + map);
}

/// Throws where the extension of the output contradicts the kind of output that follows from IN.
void check_kind(const ConvertOptions& options, bool from_directory, bool to_directory) {
  const std::string &input = options.input, &output = options.output;
  if (from_directory && has_extension(output, {".tum", ".kitti", ".txt", ".bin", ".ply", ".pcd"}))
    throw std::runtime_error(input + ": is a directory, whose scans go into a .lcmlog, not into " + output);
  if (to_directory && has_extension(output, {".lcmlog", ".xyz"}))
    throw std::runtime_error(input + ": is a log, whose scans go into a directory or a .pcd, .ply or .bin, " +
                             "and poses into a .tum or .kitti, not into " + output);
}

/// Throws for an IN that is neither a directory nor a log, unless both files are trajectories: for a cloud or
/// a map it names the extension that the output needs.
void check_file_kind(const std::string& input, const std::string& output, bool to_trajectory) {
  if (is_bare_cloud(input))
    throw std::runtime_error(output + ": name the output .map: the cloud " + input + " becomes a map");
  if (has_extension(input, {".map"}))
    throw std::runtime_error(output + ": name the output .ply or .pcd: the map " + input +
                             " becomes a cloud");
  if (!to_trajectory)
    throw std::runtime_error(output + ": name the output .tum, .kitti or .txt: " + input +
                             " is read as a trajectory, as it is neither a directory nor an LCM log");
}

void convert(const ConvertOptions& options) {
  const std::string &input = options.input, &output = options.output;
  const bool directory = std::filesystem::is_directory(input), log = !directory && is_log(input);
  const bool to_trajectory = has_extension(output, {".tum", ".kitti", ".txt"});
  const bool to_cloud = log && has_extension(output, {".pcd", ".ply", ".bin"});
  const bool to_directory = log && !to_trajectory && !to_cloud;
  const bool file = !directory && !log;
  const bool to_map = file && is_bare_cloud(input) && has_extension(output, {".map"});
  const bool from_map = file && has_extension(input, {".map"}) && is_bare_cloud(output);
  if (file && !to_map && !from_map) check_file_kind(input, output, to_trajectory);
  if (options.scan && !to_cloud)
    throw UsageError("--scan needs a log IN and a cloud OUT (.pcd, .ply or .bin)");
  if (options.up != "z" && !to_map) throw UsageError("--up needs a cloud IN and a map OUT");
  if (options.offset != ConvertOptions().offset && !to_map)
    throw UsageError("--offset needs a cloud IN and a map OUT");
  check_outputs({{input}, {to_directory ? "" : output}, to_directory ? output : ""}, options.force);
  check_kind(options, directory, to_directory);
  if (to_map) return cloud_to_map(options);
  if (from_map) return map_to_cloud(options);
  if (directory) return convert_scans(options, ScanTarget::kLog);
  if (to_directory) return convert_scans(options, ScanTarget::kDirectory);
  if (to_cloud) return convert_scans(options, ScanTarget::kCloud);
  convert_trajectory(options, log);
}

int run(const ConvertOptions& options) {
  check_usage(options);
  std::error_code error;
  if (!std::filesystem::exists(options.input, error))
    throw std::runtime_error(options.input + ": " + (error ? error.message() : "no such file or directory"));
  if (options.info) {
    show_info(options);
  } else if (!options.merged.empty()) {
    check_outputs({{options.input, options.output}, {options.merged}, ""}, options.force);
    merge_map_files(options);
  } else {
    convert(options);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<ConvertOptions>("scanlock-convert", "Scans and trajectories between LCM logs and files.",
                                     argc, argv, declare_convert_options, run);
}
