// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// What scanlock-align does for the methods that begin with 4dof.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "global/cloud_registration.hpp"

namespace scanlock {

inline constexpr const char* kGlobalMethod = "4dof";

inline bool is_global(const std::string& method) {
  return method.compare(0, 4, kGlobalMethod) == 0;
}

/// Of "4dof+robust-icp": robust-icp; of "4dof" nothing; what is no such method stays as it is.
inline std::string refining_method(const std::string& method) {
  if (method == kGlobalMethod) return "";
  return method.compare(0, 5, "4dof+") == 0 ? method.substr(5) : method;
}

/// A registration and its times, as scanlock-align reports them.
struct GlobalStart {
  CloudRegistration registration;
  DescriptionTiming timing;

  /// Where no pose was confirmed, the clouds as they are given are as good a start as any.
  bool found() const { return registration.verdict != GlobalVerdict::kNoOverlap; }
  const Pose& pose(bool refined) const {
    return refined ? registration.target_from_source : registration.start;
  }
};

inline GlobalStart find_global_start(const PointCloud& source, const PointCloud& target,
                                     const Eigen::Vector3d& up, double voxel, double epsilon) {
  GlobalStart start;
  DescriptionOptions description;
  // Thinning by less than what the description takes makes it no better.
  description.voxel = std::max(description_voxel(target), voxel);
  CloudRegistrationOptions options;
  options.epsilon = epsilon;
  start.registration = register_raw_clouds(source, target, up, description, options, &start.timing);
  return start;
}

inline void add_global(const GlobalStart& start, nlohmann::ordered_json* json) {
  const CloudRegistration& r = start.registration;
  const MatchRegistration& s = r.solution;
  (*json)["verdict"] = verdict_name(r.verdict);
  (*json)["why"] = r.why;
  (*json)["attempts"] = r.attempts;
  (*json)["epsilon"] = r.epsilon;
  (*json)["matches"] = s.matches;
  (*json)["matches_after_pruning"] = s.matches_after_pruning;
  (*json)["consensus"] = s.consensus;
  (*json)["upper_bound"] = s.upper_bound;
  (*json)["certified"] = s.certified;
  (*json)["runner_up_consensus"] = s.runner_up_consensus;
  (*json)["runner_up_bound"] = s.runner_up_bound;
  (*json)["nodes"] = r.nodes;
  (*json)["overlap"] = r.fit.overlap;
  (*json)["contradiction"] = r.fit.contradiction;
  (*json)["ms"]["keypoints"] = start.timing.keypoints_ms;
  (*json)["ms"]["features"] = start.timing.features_ms;
  (*json)["ms"]["matching"] = r.matching_ms;
  (*json)["ms"]["pruning"] = r.pruning_ms;
  (*json)["ms"]["search"] = r.search_ms;
  (*json)["ms"]["check"] = r.refinement_ms;
}

}  // namespace scanlock
