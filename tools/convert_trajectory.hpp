// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Conversion of a pose channel or a trajectory into a trajectory.
#pragma once

#include <filesystem>
#include <string>

#include "convert_options.hpp"
#include "io/trajectory_source.hpp"

namespace scanlock {

inline void convert_trajectory(const ConvertOptions& options, bool from_log) {
  LoadedTrajectory loaded = load_trajectory(
      from_log && !options.channel.empty() ? options.input + ":" + options.channel : options.input);
  if (!loaded.warning.empty()) warn(options, loaded.warning);
  Trajectory& trajectory = loaded.trajectory;
  if (std::filesystem::path(options.output).extension() == ".tum") {
    if (!loaded.has_times) {  // KITTI: poses get the stamps of scans without times.txt
      const double first_s = static_cast<double>(options.clock.first_utime()) * 1e-6;
      for (StampedPose& stamped : trajectory)
        stamped.time_s = first_s + options.clock.period_s * stamped.time_s;
    }
    write_tum(options.output, trajectory);
  } else {
    write_kitti(options.output, trajectory);
  }
  report(options, {{"poses", trajectory.size()}}, std::to_string(trajectory.size()) + " poses");
}

}  // namespace scanlock
