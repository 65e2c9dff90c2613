// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-align --chain: each cloud registered to the one before it.
#pragma once

#include <cstdio>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "align_global.hpp"
#include "align_input.hpp"
#include "align_options.hpp"
#include "align_report.hpp"
#include "icp/cloud_chain.hpp"
#include "icp/cloud_thinning.hpp"
#include "io/cloud_file.hpp"
#include "io/progress_bar.hpp"
#include "io/trajectory.hpp"

namespace scanlock {

inline void append(const PointCloud& cloud, PointCloud* map) {
  map->x.insert(map->x.end(), cloud.x.begin(), cloud.x.end());
  map->y.insert(map->y.end(), cloud.y.begin(), cloud.y.end());
  map->z.insert(map->z.end(), cloud.z.begin(), cloud.z.end());
}

inline std::optional<GlobalStart> global_link(const AlignOptions& options, GlobalSearch& search,
                                              const std::string& source_path, const PointCloud& source,
                                              const std::string& target_path, const PointCloud& target) {
  if (!is_global(options.method) || target.empty()) return std::nullopt;
  GlobalStart link = search.next(source, target);
  const AlignVerdict verdict = verdict_of(link.registration);
  if (verdict.least > acceptance(options.accept)) {
    const std::string words = source_path + " to " + target_path + ": " + verdict.why;
    if (!options.json)
      throw std::runtime_error(
          words + "; --json continues with the next pair, --method robust-icp-plane assumes small motions");
    std::cerr << "scanlock-align: " << words << "\n";
  }
  return link;
}

/// The start for a link of the chain; nothing where the global search found no pose, and the chain guesses by
/// itself.
inline std::optional<ChainGuess> chain_guess(const AlignOptions& options,
                                             const std::optional<GlobalStart>& link) {
  if (!link) return std::nullopt;
  const bool refined = !refining_method(options.method).empty();
  if (refined && !link->found()) return std::nullopt;
  const double nu_max = options.nu_max > 0 ? options.nu_max : link->registration.epsilon;
  return ChainGuess{link->pose(refined), nu_max, refined};
}

inline Json link_json(const CloudAlignment& link, const std::optional<GlobalStart>& global) {
  Json json = {{"transform", row_major(link.target_from_source.matrix())},
               {"stop_reason", link.stop_reason},
               {"inlier_ratio", link.inlier_ratio},
               {"degenerate_axes", axis_names(link.degenerate_axes)}};
  if (global) add_global(*global, &json);
  return json;
}

inline void print_chain(const AlignOptions& options, const Json& json, const Trajectory& trajectory) {
  if (options.json) {
    print_json(json);
    return;
  }
  for (const StampedPose& stamped : trajectory) {
    const Eigen::Vector3d t = stamped.pose.translation();
    const Eigen::Quaterniond q(stamped.pose.linear());
    std::printf("%.0f %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", stamped.time_s, t.x(), t.y(), t.z(), q.x(),
                q.y(), q.z(), q.w());
  }
  for (const auto& link : json["links"]) {
    const std::string reason = link["stop_reason"];
    if (!reason.empty() && reason != "converged" && reason != "start")
      std::cerr << link["source"].get<std::string>() << ": " << reason << "\n";
  }
}

inline void run_chain(const AlignOptions& options) {
  Stopwatch whole;
  std::vector<std::string> paths = {options.source, options.target};
  paths.insert(paths.end(), options.more.begin(), options.more.end());
  const std::string refining = refining_method(options.method);
  CloudAlignmentOptions alignment = alignment_options(options);
  alignment.start_may_be_better = is_global(options.method);
  CloudChain chain(refining.empty() ? CloudMethod{} : *find_cloud_method(refining), alignment,
                   options.voxel >= 0 ? std::optional<double>(options.voxel) : std::nullopt);
  GlobalSearch search(Eigen::Vector3d(options.up.data()), options.voxel, options.epsilon);
  std::optional<ProgressBar> bar(std::in_place, "aligning");
  PointCloud map, before;
  Trajectory trajectory;
  Json links = Json::array();
  double length = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    PointCloud cloud = read_points(paths[i]);
    const std::optional<GlobalStart> global =
        global_link(options, search, paths[i], cloud, paths[i > 0 ? i - 1 : 0], before);
    std::optional<CloudAlignment> link;
    try {
      link = chain.add(cloud, chain_guess(options, global));
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(paths[i] + ": " + error.what());
    }
    trajectory.push_back({static_cast<double>(i), chain.poses().back()});
    if (!options.output.empty()) append(moved(thinned_by(cloud, chain.voxel()), chain.poses().back()), &map);
    bar->update(i + 1, paths.size());
    if (is_global(options.method)) before = std::move(cloud);
    if (!link) continue;
    length += link->target_from_source.translation().norm();
    links.push_back({{"source", paths[i]}, {"target", paths[i - 1]}});
    links.back().update(link_json(*link, global));
  }
  bar.reset();
  if (!options.poses.empty()) write_tum(options.poses, trajectory);
  // Overlapping clouds are thinned together to one point per voxel.
  if (!options.output.empty()) write_cloud(options.output, thinned_by(map, chain.voxel()));
  print_chain(options,
              {{"method", options.method},
               {"clouds", paths.size()},
               {"length", length},
               {"links", links},
               {"ms", {{"total", whole.lap()}}},
               {"peak_rss_mb", peak_rss_mb()}},
              trajectory);
}

}  // namespace scanlock
