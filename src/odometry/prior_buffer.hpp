// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "geometry/rigid.hpp"

namespace scanlock {

/// Measurements of other sensors at one instant. `local` and `level` are the sensors' frames; `body` is the
/// robot's.
struct PriorSample {
  std::optional<Pose> odometry;                       ///< local_from_body
  std::optional<Eigen::Quaterniond> level_from_body;  ///< attitude; its heading is not used
};

/// The recent stamped poses of another sensor, interpolated at the stamps of scans. The results depend only
/// on the poses added, not on a clock. Bounded. Stamps (`utime`) are microseconds.
class PriorBuffer {
 public:
  enum class Addition : std::int8_t {
    kTaken,
    kRestarted,  ///< over a second earlier than the sample before it: another run began, older samples are
                 ///< dropped
    kBackward,   ///< up to a second earlier than the sample before it, or the same stamp: ignored
    kNotFinite,  ///< ignored
  };
  Addition add(std::int64_t utime, const Pose& pose);

  enum class Absence : std::int8_t {
    kNone,     ///< there is a pose
    kNever,    ///< no pose was ever added
    kStale,    ///< no pose near that instant
    kShifted,  ///< poses are added, but their stamps are over a second off: two clocks
  };
  struct Answer {
    std::optional<Pose> pose;
    Absence absence = Absence::kNone;
    double offset_s = 0;  ///< the newest stamp minus the instant asked for
  };
  /// The pose at `utime`: interpolated between two samples that are at most half a second apart, or
  /// extrapolated by at most 0.1 s.
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
  /// Seconds from the instant last asked for to the newest sample, when that sample arrived: distinguishes a
  /// sensor with another clock from one that fell silent.
  std::optional<double> arrival_offset_s_;
};

/// "0.41 s behind" for an offset of -0.41, "12.00 s ahead" for one of 12.
std::string offset_words(double offset_s);

}  // namespace scanlock
