// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/pose_graph.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"

namespace scanlock {

/// Node of the map's frame in the graph; keyframes have greater numbers.
inline constexpr std::uint32_t kOriginNode = 0;

/// The wanted keyframes within `reach` metres of a position, the nearest first; at most as many as one side
/// of a closure is made from.
std::vector<ArchivedKeyframe> nearest_to(const Eigen::Vector3d& position, double reach,
                                         const std::vector<ArchivedKeyframe>& keyframes,
                                         const std::function<bool(const ArchivedKeyframe&)>& is_wanted);

/// A keyframe to be aligned with keyframes of an earlier visit, and the graph to be optimised by it. A
/// value: it can be worked on by another thread while the tracker goes on.
struct ClosureRequest {
  std::int64_t serial = 0;
  PoseGraph graph;
  ArchivedKeyframe keyframe;
  std::uint32_t nearest = 0;  ///< node of the earlier visit: a keyframe, or kOriginNode where that is fixed
  std::uint32_t nearest_keyframe = 0;        ///< the same, where that is a keyframe
  Pose own_from_nearest = Pose::Identity();  ///< own: the frame of the keyframes below
  std::vector<ArchivedKeyframe> earlier;     ///< around it, of the earlier visit
  std::vector<ArchivedKeyframe> recent;      ///< around it, of this visit, without the keyframe itself
  std::optional<Constraint> pending;         ///< a closure of the keyframe before, which needs a second one
  Matrix6 usual_information = Matrix6::Identity();  ///< of the last closure
  double voxel = 0;                                 ///< metres
  bool planar = false;
  Odometer::Usual usual;
};

enum class ClosureOutcome : std::int8_t {
  kKnown,     ///< the graph's covariance of the relative pose is about that of a closure already
  kRefused,   ///< the keyframe is not explained there, or too far from the graph's prediction
  kPending,   ///< found; the next one has to agree
  kAccepted,  ///< two agree, and the graph was optimised
};

struct ClosureAnswer {
  std::int64_t serial = 0;
  std::uint32_t keyframe = 0, nearest = 0, nearest_keyframe = 0;  ///< as in the request
  ClosureOutcome outcome = ClosureOutcome::kRefused;
  std::string reason;     ///< in words
  std::string map_fault;  ///< see TrackedScan; refused then
  /// Of the keyframe in the frame of `nearest`, with the closure where one is accepted.
  Matrix6 covariance = Matrix6::Zero();
  Constraint closure;  ///< from `nearest` to the keyframe; of a pending and an accepted one
  // Of an accepted one:
  std::map<std::uint32_t, Pose> map_from_node;
  Matrix6 drift = Matrix6::Zero();  ///< covariance of the keyframe in the map's frame
};

/// Aligns the keyframe with the earlier visit, from where the graph puts it. Found when its share of inliers
/// there is at least four fifths of that among the recent keyframes, and the squared Mahalanobis distance to
/// the graph's pose is below kOnceInThousand; accepted when the closure before agrees on the relative pose of
/// the two visits.
ClosureAnswer close_loop(const ClosureRequest& request, const TrackerConfig& config);

/// A closure, before anything else agrees with it.
struct FoundClosure {
  Constraint constraint;
  double more_energy = 0;  ///< of the keyframe's alignment there, beyond that among the recent ones
};

/// The closure of the keyframe with `nearest`, where it is `expected` (frame of the earlier keyframes) to
/// within a covariance; none where it is not found. `reason`: what was found, in words.
std::optional<FoundClosure> find_closure(const ClosureRequest& request, const Pose& expected,
                                         const Matrix6& covariance, const TrackerConfig& config,
                                         std::string* reason);
/// Sets the odometer's usual energy to that of the keyframe aligned with the recent ones, at its pose.
void learn_usual(const ClosureRequest& request, Odometer* odometer);
/// Whether two closures agree on the relative pose of the two visits, within the covariances of both and of
/// the ways between them.
bool agree(const PoseGraph& earlier_visit, const PoseGraph& this_visit, const Constraint& a,
           const Constraint& b);

/// Whether a closure with the usual information would reduce the covariance notably along some direction.
bool is_worthwhile(const Matrix6& covariance, const Matrix6& usual_information);

/// The squared Mahalanobis distance that one pose in a thousand exceeds (chi-square, 6 degrees of freedom).
inline constexpr double kOnceInThousand = 22.46;

}  // namespace scanlock
