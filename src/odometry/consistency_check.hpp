// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "odometry/prior_buffer.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// The consistency check of auxiliary odometry and attitude: converts their measurements of the body into
/// priors of the sensor, and compares each with the tracked scan. A source gets one strike for each scan that
/// it contradicts, and loses one for each scan that it agrees with. It is withheld from kStrikesOut strikes
/// on, until it has none left.
class ConsistencyCheck {
 public:
  explicit ConsistencyCheck(const Pose& body_from_sensor) : body_from_sensor_(body_from_sensor) {}

  /// The prior, of the sensor, for the scan at which `sample` was taken.
  ScanPrior prior(const PriorSample& sample) const;

  /// Compares `sample` with its scan as tracked (poses of the sensor). Returns a sentence when a source has
  /// become withheld or trusted again.
  std::optional<std::string> learn(const PriorSample& sample, const TrackedScan& tracked);

  std::int64_t contradictions() const { return motion_.contradictions + level_.contradictions; }
  bool trusts_odometry() const { return motion_.trusted; }
  bool trusts_attitude() const { return level_.trusted; }

 private:
  struct Trust {
    bool trusted = true;
    int strikes = 0;
    std::int64_t contradictions = 0;
    /// Counts one scan; true when `trusted` changed.
    bool count(bool contradicts);
  };
  std::optional<Pose> sensor_motion(const PriorSample& sample) const;
  std::optional<std::string> learn_motion(const PriorSample& sample, const TrackedScan& tracked);
  std::optional<std::string> learn_level(const PriorSample& sample, const TrackedScan& tracked);

  Pose body_from_sensor_;
  Trust motion_, level_;
  bool any_ = false;  ///< last_sample_ and last_tracked_ are those of the scan before
  PriorSample last_sample_;
  TrackedScan last_tracked_;
  std::optional<Eigen::Vector3d> up_;  ///< upward direction by the attitude sensor, map frame; smoothed
};

}  // namespace scanlock
