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

/// Those of some keyframes within `reach` metres of a position, the nearest first; as many as one side of a
/// closure is made from.
std::vector<ArchivedKeyframe> nearest_to(const Eigen::Vector3d& position, double reach,
                                         const std::vector<ArchivedKeyframe>& keyframes,
                                         const std::function<bool(const ArchivedKeyframe&)>& is_wanted);

/// A keyframe to be aligned with what an earlier visit saw there, and the graph to be optimised by it. A
/// value: it can be worked on by another thread while the tracker goes on.
struct ClosureRequest {
  std::int64_t serial = 0;
  PoseGraph graph;
  ArchivedKeyframe keyframe;
  std::uint32_t nearest = 0;  ///< node of the earlier visit: a keyframe, or kOriginNode where that is fixed
  std::uint32_t nearest_keyframe = 0;        ///< the same, where that is a keyframe
  Pose own_from_nearest = Pose::Identity();  ///< own: the frame of the keyframes below
  std::vector<ArchivedKeyframe> earlier;     ///< around it: that visit's
  std::vector<ArchivedKeyframe> recent;      ///< around it: this visit's, without the keyframe itself
  std::optional<Constraint> pending;         ///< a closure of the keyframe before, which needs a second one
  Matrix6 usual_information = Matrix6::Identity();  ///< of the last closure
  double voxel = 0;                                 ///< metres
  bool planar = false;
  Odometer::Usual usual;
};

enum class ClosureOutcome : std::int8_t {
  kKnown,     ///< the graph knows how the two lie to each other about as well as a closure would tell
  kRefused,   ///< the keyframe is not explained there, or too far off
  kPending,   ///< found; another one has to agree
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

/// Aligns the keyframe with the earlier visit, from where the graph puts it. Found when as much of it is
/// explained there as in what was seen around it just now, within a fifth, and no farther off than the
/// covariances allow in all but one of a thousand; accepted when the one before says the same of how the two
/// visits lie to each other.
ClosureAnswer close_loop(const ClosureRequest& request, const TrackerConfig& config);

/// The closure of the keyframe with `nearest`, where it is `expected` (frame of the earlier keyframes) to
/// within a covariance; none where it is not found. `reason`: what was found, in words.
std::optional<Constraint> find_closure(const ClosureRequest& request, const Pose& expected,
                                       const Matrix6& covariance, const TrackerConfig& config,
                                       std::string* reason);
/// An odometer learns what it costs to align the keyframe with the recent ones, where it is.
void learn_usual(const ClosureRequest& request, Odometer* odometer);
/// Whether two closures say the same of how the two visits lie to each other, as far as they and the ways
/// between them are known.
bool agree(const PoseGraph& earlier_visit, const PoseGraph& this_visit, const Constraint& a,
           const Constraint& b);

/// Whether there is a direction in which a closure with the usual information would say more than is known.
bool is_worthwhile(const Matrix6& covariance, const Matrix6& usual_information);

/// The squared Mahalanobis distance that one pose in a thousand exceeds (chi-square, 6 degrees of freedom).
inline constexpr double kOnceInThousand = 22.46;

}  // namespace scanlock
