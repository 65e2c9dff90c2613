// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/matching.hpp"

namespace scanlock {

/// How the estimate is laid over the reference before absolute errors are taken.
/// kNone: both are compared as they stand, so they must share a frame.
/// kYaw: the best translation and rotation about z, for an estimate that knows where down is.
/// kSe3: the best rigid motion (Umeyama without scale), what evo and KISS-ICP call aligned.
enum class Overlay { kNone, kYaw, kSe3 };

/// Pairs that an overlay needs at least.
std::size_t poses_needed(Overlay kind);

/// reference_from_estimate, by least squares over the positions of the pairs. With positions on a line, the
/// rotation about that line is arbitrary under kSe3.
Pose overlay(const PosePairs& pairs, Overlay kind);

/// Distances between matched positions after the overlay, metres, in the order of the pairs.
std::vector<double> position_errors(const PosePairs& pairs, const Pose& reference_from_estimate);

struct AbsoluteError {
  double rmse = 0, median = 0, max = 0;  ///< metres
};
AbsoluteError absolute_error(const std::vector<double>& errors);  ///< `errors` must not be empty

struct RelativeError {
  double percent = 0;    ///< translation error per way, mean over all stretches
  double deg_per_m = 0;  ///< rotation error per way, mean over all stretches
  std::size_t stretches = 0;
};

/// Relative pose error over a stretch of way. From each pair, a stretch leads to the first later pair that is
/// at least `length_m` further along the reference; its error is (motion of the reference)^-1 (motion of the
/// estimate), divided by the way really covered. Nothing when the way is too short for a single stretch. No
/// overlay changes it.
std::optional<RelativeError> relative_error(const PosePairs& pairs, double length_m);
/// Over the stretches within each of the runs.
std::optional<RelativeError> relative_error(const std::vector<PosePairs>& runs, double length_m);

/// As KITTI's development kit does it: stretches of 100, 200 .. 800 m from every tenth pair, mean over all of
/// them.
std::optional<RelativeError> kitti_error(const PosePairs& pairs);

constexpr std::array<double, 3> kRelativeLengths = {1, 10, 100};  ///< metres

struct Evaluation {
  std::size_t poses = 0;    ///< of the estimate
  std::size_t matched = 0;  ///< of them, with a reference pose
  double length_m = 0;      ///< way of the reference from the first match to the last
  Pose reference_from_estimate = Pose::Identity();
  AbsoluteError ate_m;
  std::array<std::optional<RelativeError>, kRelativeLengths.size()> rpe;  ///< for kRelativeLengths
  std::optional<RelativeError> kitti;
};

/// All of it. Throws std::runtime_error when there are no pairs, or too few for the overlay (2 for yaw, 3 for
/// se3).
Evaluation evaluate(const PosePairs& pairs, std::size_t poses, Overlay kind);

}  // namespace scanlock
