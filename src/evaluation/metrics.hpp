// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/matching.hpp"

namespace scanlock {

/// How the estimate is aligned with the reference before absolute errors are computed.
/// kNone: not aligned; both must be in the same frame.
/// kYaw: the best translation and rotation about z, for an estimate whose z axis is vertical.
/// kSe3: the best rigid motion (Umeyama without scale), as evo and KISS-ICP align.
enum class Overlay { kNone, kYaw, kSe3 };

/// The least number of pairs for an alignment.
std::size_t poses_needed(Overlay kind);

/// reference_from_estimate, by least squares over the positions of the pairs. With kSe3 and positions on a
/// line, the rotation about that line is arbitrary.
Pose overlay(const PosePairs& pairs, Overlay kind);

/// Distances between paired positions after the alignment, metres, in the order of the pairs.
std::vector<double> position_errors(const PosePairs& pairs, const Pose& reference_from_estimate);

struct AbsoluteError {
  double rmse = 0, median = 0, max = 0;  ///< metres
};
AbsoluteError absolute_error(const std::vector<double>& errors);  ///< `errors` must not be empty

struct RelativeError {
  double percent = 0;    ///< translation error per path length, mean over all stretches
  double deg_per_m = 0;  ///< rotation error per path length, mean over all stretches
  std::size_t stretches = 0;
};

/// Relative pose error over stretches of the path. From each pair, a stretch leads to the first later pair
/// that is at least `length_m` metres farther along the reference; its error is (motion of the reference)^-1
/// (motion of the estimate), divided by the actual length of the stretch. Nothing when the path is too short
/// for one stretch. The result does not depend on an alignment.
std::optional<RelativeError> relative_error(const PosePairs& pairs, double length_m);
/// As above, with stretches that lie within one of the runs.
std::optional<RelativeError> relative_error(const std::vector<PosePairs>& runs, double length_m);

/// As KITTI's development kit computes it: stretches of 100, 200 .. 800 m from every tenth pair, mean over
/// all stretches.
std::optional<RelativeError> kitti_error(const PosePairs& pairs);

constexpr std::array<double, 3> kRelativeLengths = {1, 10, 100};  ///< metres

struct Evaluation {
  std::size_t poses = 0;    ///< of the estimate
  std::size_t matched = 0;  ///< of these, poses with a reference pose
  double length_m = 0;      ///< metres, path length of the reference from the first pair to the last
  Pose reference_from_estimate = Pose::Identity();
  AbsoluteError ate_m;
  std::array<std::optional<RelativeError>, kRelativeLengths.size()> rpe;  ///< for each of kRelativeLengths
  std::optional<RelativeError> kitti;
};

/// All metrics. Throws std::runtime_error when there are no pairs, or too few for the alignment (2 for yaw, 3
/// for se3).
Evaluation evaluate(const PosePairs& pairs, std::size_t poses, Overlay kind);

}  // namespace scanlock
