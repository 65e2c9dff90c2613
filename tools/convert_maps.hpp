// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Conversions of maps: from a cloud, to a cloud, and two maps into one.
#pragma once

#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>

#include "convert_options.hpp"
#include "daemon/map_store.hpp"
#include "geometry/rigid.hpp"
#include "io/cloud_file.hpp"
#include "io/map_file.hpp"
#include "mapping/cloud_map.hpp"
#include "mapping/map_merge.hpp"
#include "mapping/submap.hpp"

namespace scanlock {

inline void report_map(const ConvertOptions& options, const SavedMap& map, std::size_t points) {
  report(options, {{"keyframes", map.keyframes.size()}, {"points", points}},
         std::to_string(map.keyframes.size()) + " keyframes, " + std::to_string(points) + " points");
}

inline void cloud_to_map(const ConvertOptions& options) {
  check_map_path(options.output);
  CloudMapOptions how;
  how.threads = machine_threads();
  how.map_from_cloud = Pose(level_rotation(axis_of(options.up)));
  CloudMapBuilder builder(how);
  std::size_t points = 0;
  {
    ProgressBar bar("points");
    const auto take = [&](PointCloud&& part) {
      points += part.size();
      builder.add(std::move(part));
    };
    read_cloud(options.input, take, bar.updater(), Eigen::Vector3d(options.offset.data()));
  }
  SavedMap map;
  {
    ProgressBar bar("map");
    map = builder.build(options.input, bar.updater());
  }
  for (const std::string& warning : builder.warnings()) warn(options, warning);
  write_map(options.output, map);
  report_map(options, map, points);
}

inline void map_to_cloud(const ConvertOptions& options) {
  constexpr float kVoxel = 0.05F;  // metres
  const SavedMap all = read_map(options.input), map = first_submap(all);
  if (const std::size_t others = all.keyframes.size() - map.keyframes.size(); others > 0)
    std::cerr << options.input << ": " << others
              << " keyframes are left out: their submaps are not joined to the first one\n";
  const PointCloud cloud = cloud_of_map(map, kVoxel);
  write_cloud(options.output, cloud);
  report_map(options, map, cloud.size());
}

inline void merge_map_files(const ConvertOptions& options) {
  check_map_path(options.merged);
  const SavedMap first = read_map(options.input), second = read_map(options.output);
  MapMerge merged;
  {
    ProgressBar bar("overlap");
    merged = merge_maps(first, second, {}, bar.updater());
  }
  if (!merged.joined) {
    const std::string others =
        merged.otherwise > 1 ? ", and " + std::to_string(merged.otherwise) + " on another" : "";
    throw std::runtime_error(options.output + ": no overlap with " + options.input +
                             " is accepted, and no map is written: of " + std::to_string(merged.searches) +
                             " keyframes searched for, " + std::to_string(merged.found) +
                             " were found in the other map, and " + std::to_string(merged.agreeing) +
                             " of them agree on one pose of it" + others);
  }
  write_map(options.merged, merged.map);
  report(options,
         {{"keyframes", merged.map.keyframes.size()},
          {"searches", merged.searches},
          {"found", merged.found},
          {"agreeing", merged.agreeing},
          {"closures", merged.closures}},
         std::to_string(merged.map.keyframes.size()) + " keyframes, " + std::to_string(merged.closures) +
             " loop closures between the two");
}

}  // namespace scanlock
