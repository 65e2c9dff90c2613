// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "geometry/rigid.hpp"

namespace scanlock {

/// Measurements of other sensors at one instant. Frames are those sensors' own; body is the robot's.
struct PriorSample {
  std::optional<Pose> odometry;                       ///< local_from_body
  std::optional<Eigen::Quaterniond> level_from_body;  ///< attitude; its heading is not used
};

/// The recent stamped poses of another sensor, interpolated at the stamps of scans. Depends on the poses
/// added alone, not on a clock. Bounded.
class PriorBuffer {
 public:
  enum class Addition : std::int8_t {
    kTaken,
    kRestarted,  ///< earlier than the one before by over a second: another run began, the old ones are
                 ///< forgotten
    kBackward,   ///< earlier than the one before, or the same: ignored
    kNotFinite,  ///< ignored
  };
  Addition add(std::int64_t utime, const Pose& pose);

  enum class Absence : std::int8_t {
    kNone,     ///< there is a pose
    kNever,    ///< no pose was ever added
    kStale,    ///< no pose near that instant
    kShifted,  ///< poses are added, but stamped over a second off: two clocks
  };
  struct Answer {
    std::optional<Pose> pose;
    Absence absence = Absence::kNone;
    double offset_s = 0;  ///< the newest stamp minus the instant asked for
  };
  /// The pose at `utime`: between two samples that are less than half a second apart, or at most 0.1 s after
  /// the newest.
  Answer at(std::int64_t utime);

 private:
  struct Sample {
    std::int64_t utime;
    Pose pose;
  };
  std::optional<Pose> interpolated(std::int64_t utime) const;
  std::optional<Pose> extrapolated(std::int64_t utime) const;

  std::deque<Sample> samples_;  ///< oldest first, stamps strictly ascending
  std::optional<std::int64_t> last_asked_;
  /// Seconds from the instant last asked for to the newest sample, when that came: tells a sensor with
  /// another clock from one that fell silent.
  std::optional<double> arrival_offset_s_;
};

/// "0.41 s behind", for an offset that is negative, or "12.00 s ahead".
std::string offset_words(double offset_s);

}  // namespace scanlock
