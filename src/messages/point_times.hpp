// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanlock {

/// What the numbers in a time field are made of.
enum class TimeKind : std::int8_t {
  kInteger,  ///< 32-bit: nanoseconds after the stamp (Ouster `t`, Livox `offset_time`)
  kFloat32,  ///< seconds after the stamp (Velodyne `time`); too coarse for anything else
  kFloat64,  ///< seconds after the stamp, or since the epoch in s, ms, us or ns (Hesai, RoboSense, Livox 2)
  kMicrosecondsOfEpoch,  ///< by the definition of the type (MBot)
};

/// How good a name is for the field with the time of each point: 0 is the best, nothing if it is no such
/// name. Letter case does not matter; a unit may be appended: `_s`, `_ms`, `_us`, `_ns` (or `_nsec` and so
/// on).
std::optional<int> time_name_rank(std::string_view name);

/// Turns the numbers of a time field into seconds relative to `utime` (microseconds).
/// A unit in the name decides; else the kind; among several possible readings, the one that puts the points
/// nearest to the stamp. A reading is only accepted when stamp and points lie within 10 s: else `seconds`
/// comes back empty, since wrong times are worse than none. With utime <= 0, epoch times are taken relative
/// to the earliest point. Returns a sentence that says how the field was read, or why it was not.
std::string interpret_times(std::string_view name, TimeKind kind, std::int64_t utime,
                            const std::vector<double>& raw, std::vector<float>& seconds);

}  // namespace scanlock
