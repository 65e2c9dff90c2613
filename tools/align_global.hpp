// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The global registration of scanlock-align, for the methods whose names begin with 4dof.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "global/cloud_registration.hpp"
#include "global/hypothesis.hpp"

namespace scanlock {

inline constexpr const char* kGlobalMethod = "4dof";

inline bool is_global(const std::string& method) {
  return method.compare(0, 4, kGlobalMethod) == 0;
}

/// The method that refines: "robust-icp" for "4dof+robust-icp", "" for "4dof", and any other method itself.
inline std::string refining_method(const std::string& method) {
  if (method == kGlobalMethod) return "";
  return method.compare(0, 5, "4dof+") == 0 ? method.substr(5) : method;
}

/// A registration and its times, as scanlock-align reports them.
struct GlobalStart {
  CloudRegistration registration;
  double keypoints_ms = 0, features_ms = 0;  // CPU time, for the clouds that had to be described

  /// Whether a pose was confirmed; otherwise the clouds are taken as they are given.
  bool found() const { return registration.verdict != GlobalVerdict::kNoOverlap; }
  const Pose& pose(bool refined) const {
    return refined ? registration.target_from_source : registration.start;
  }
  /// Whether `refined` is too far from the confirmed pose to be a refinement of it, for that pose is known to
  /// a part of epsilon. `centre`: of the source, metres.
  bool is_left_by(const Pose& refined, const Eigen::Vector3d& centre) const {
    constexpr double kFar = 0.25;  // of the separation of different poses: epsilon, or 1.4 degrees
    return found() && separation(refined, pose(true), centre, registration.epsilon) > kFar;
  }
};

/// Registers a sequence of clouds, each to the one before it.
class GlobalSearch {
 public:
  GlobalSearch(const Eigen::Vector3d& up, double voxel, double epsilon) : up_(up), voxel_(voxel) {
    options_.epsilon = epsilon;
  }

  /// `target` is the source of the last call, if there was one. Its description is reused unless the voxel
  /// that the target needs differs by more than a factor of 1.25.
  GlobalStart next(const PointCloud& source, const PointCloud& target) {
    constexpr double kAnotherVoxel = 1.25;
    GlobalStart start;
    // A voxel below that of the description does not improve the description.
    const double voxel = std::max(description_voxel(target), voxel_);
    const double ratio = known_ ? known_->voxel / voxel : 0;
    if (!(ratio > 1 / kAnotherVoxel && ratio < kAnotherVoxel)) known_ = described(target, voxel, &start);
    CloudDescription of_source = described(source, known_->voxel, &start);
    start.registration = register_levelled(of_source, *known_, up_, options_);
    known_ = std::move(of_source);
    return start;
  }

 private:
  CloudDescription described(const PointCloud& cloud, double voxel, GlobalStart* start) const {
    DescriptionOptions options;
    options.voxel = voxel;
    CloudDescription description = describe_levelled(cloud, up_, options);
    start->keypoints_ms += description.points_ms + description.keypoints_ms;
    start->features_ms += description.features_ms;
    return description;
  }

  Eigen::Vector3d up_;
  double voxel_;  // metres, the smallest
  CloudRegistrationOptions options_;
  std::optional<CloudDescription> known_;  // the description of the next target
};

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
  (*json)["ms"]["keypoints"] = start.keypoints_ms;
  (*json)["ms"]["features"] = start.features_ms;
  (*json)["ms"]["matching"] = r.matching_ms;
  (*json)["ms"]["pruning"] = r.pruning_ms;
  (*json)["ms"]["search"] = r.search_ms;
  (*json)["ms"]["check"] = r.refinement_ms;
}

}  // namespace scanlock
