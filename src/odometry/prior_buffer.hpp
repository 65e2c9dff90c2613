// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "geometry/rigid.hpp"

namespace scanlock {

/// What another sensor says of one instant. Frames are the other sensor's own; body is the robot's.
struct PriorSample {
  std::optional<Pose> odometry;                       ///< local_from_body
  std::optional<Eigen::Quaterniond> level_from_body;  ///< attitude; only roll and pitch mean something
};

/// The recent stamped poses of another sensor, for asking where it was at the stamp of a scan. A plain value
/// of what was added: no clock. Bounded.
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
    kNone,     ///< there is an answer
    kNever,    ///< nothing ever came
    kStale,    ///< nothing came near that instant
    kShifted,  ///< they come, but stamped over a second off: two clocks
  };
  struct Answer {
    std::optional<Pose> pose;
    Absence absence = Absence::kNone;
    double offset_s = 0;  ///< the newest stamp against the instant asked for
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
