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

/// Node of the map's frame in the graph; the ids of keyframes are greater.
inline constexpr std::uint32_t kOriginNode = 0;

/// Keyframes from which one side of a closure is made: a cap on its cost.
inline constexpr std::size_t kMostAround = 20;

/// The wanted keyframes within `reach` metres of a position, the nearest first.
std::vector<ArchivedKeyframe> nearest_to(const Eigen::Vector3d& position, double reach,
                                         const std::vector<ArchivedKeyframe>& keyframes,
                                         const std::function<bool(const ArchivedKeyframe&)>& is_wanted,
                                         std::size_t most = kMostAround);

/// A keyframe, and the nearest keyframe of an earlier visit.
struct Revisit {
  std::uint32_t keyframe = 0;
  std::uint32_t nearest = 0;           ///< its node: that keyframe, or kOriginNode where it is fixed
  std::uint32_t nearest_keyframe = 0;  ///< its id, also where it is fixed
  /// Of the keyframe's pose in the frame of `nearest`.
  Matrix6 covariance = Matrix6::Zero();
};

/// A keyframe to be aligned with keyframes of an earlier visit, and the graph to be optimised with the
/// closure. A value: another thread can work on it while the tracker goes on.
struct ClosureRequest {
  std::int64_t serial = 0;
  PoseGraph graph;
  ArchivedKeyframe keyframe;
  std::uint32_t nearest = 0, nearest_keyframe = 0;  ///< see Revisit
  /// Keyframes of this visit whose covariances are wanted, `keyframe` among them.
  std::vector<Revisit> revisits;
  Pose own_from_nearest = Pose::Identity();  ///< own: the frame of the keyframes below
  std::vector<ArchivedKeyframe> earlier;     ///< keyframes of the earlier visit around it
  std::vector<ArchivedKeyframe> recent;      ///< keyframes of this visit around it, without itself
  /// The closure of an earlier keyframe, which needs a second closure that agrees.
  std::optional<Constraint> pending;
  Matrix6 usual_information = Matrix6::Identity();  ///< of the last closure
  double voxel = 0;                                 ///< metres
  bool planar = false;
  Odometer::Usual usual;
};

enum class ClosureOutcome : std::int8_t {
  kKnown,     ///< not aligned: the graph knows the relative pose about as well as a closure would
  kRefused,   ///< the earlier keyframes do not explain it, or its pose is too far from the graph's prediction
  kPending,   ///< found; the next closure has to agree
  kAccepted,  ///< two closures agree, and the graph was optimised
};

struct ClosureAnswer {
  std::int64_t serial = 0;
  std::uint32_t keyframe = 0, nearest = 0, nearest_keyframe = 0;  ///< as in the request
  ClosureOutcome outcome = ClosureOutcome::kRefused;
  std::string reason;     ///< in words
  std::string map_fault;  ///< see TrackedScan; where there is one the outcome is kRefused
  Constraint closure;     ///< from `nearest` to the keyframe; only of kPending and kAccepted
  /// As in the request, with their covariances; only of kKnown and kAccepted, then after optimisation with
  /// the closure.
  std::vector<Revisit> revisits;
  // Only of kAccepted:
  std::map<std::uint32_t, Pose> map_from_node;
  Matrix6 drift = Matrix6::Zero();  ///< covariance of the keyframe's pose in the map's frame
};

/// Aligns the keyframe with the earlier visit, starting at its pose in the graph. The closure is found when
/// the inlier ratio is at least four fifths of that among the recent keyframes and the squared Mahalanobis
/// distance to the graph's pose is below kOnceInThousand; it is accepted when the pending closure agrees on
/// the relative pose of the two visits.
ClosureAnswer close_loop(const ClosureRequest& request, const TrackerConfig& config);

/// A closure that no other closure has confirmed yet.
struct FoundClosure {
  Constraint constraint;
  /// Energy of the alignment with the earlier keyframes less that with the recent ones.
  double more_energy = 0;
};

/// The closure of the keyframe with `nearest`, searched for around the pose `expected` (frame of the earlier
/// keyframes) with this covariance; none where it is not found. `reason`: the result in words.
std::optional<FoundClosure> find_closure(const ClosureRequest& request, const Pose& expected,
                                         const Matrix6& covariance, const TrackerConfig& config,
                                         std::string* reason);
/// Adds the alignment of the keyframe with the recent keyframes, at its own pose, to the odometer's running
/// statistics.
void learn_usual(const ClosureRequest& request, Odometer* odometer);
/// Whether two closures agree on the relative pose of the two visits, within the covariances of both closures
/// and of the paths between their ends: squared Mahalanobis distance below kOnceInThousand. `earlier_visit`
/// is the pose of b.from in a.from, `this_visit` that of b.to in a.to.
bool agree(const RelativePose& earlier_visit, const RelativePose& this_visit, const Constraint& a,
           const Constraint& b);

/// Whether along some direction the variance is at least twice that of a closure with the usual information.
bool is_worthwhile(const Matrix6& covariance, const Matrix6& usual_information);

/// The squared Mahalanobis distance that one pose in a thousand exceeds (chi-square, 6 degrees of freedom).
inline constexpr double kOnceInThousand = 22.46;

}  // namespace scanlock
