// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanlock {

/// The type of the numbers in a time field, and the interpretations that it permits without a unit in the
/// name.
enum class TimeKind : std::int8_t {
  kInteger,  ///< 32 bits: nanoseconds after the stamp (Ouster `t`, Livox `offset_time`)
  kFloat32,  ///< seconds after the stamp (Velodyne `time`); too coarse for times since the epoch
  kFloat64,  ///< seconds after the stamp, or since the epoch in s, ms, us or ns (Hesai, RoboSense, Livox 2)
  kMicrosecondsOfEpoch,  ///< as the type defines it (MBot)
};

/// The rank of a name for the field with the times of the points: 0 is best; nothing when it is not such a
/// name. Letter case is ignored; a unit may be appended: `_s`, `_ms`, `_us`, `_ns` (or `_sec`, `_msec`,
/// `_usec`, `_nsec`).
std::optional<int> time_name_rank(std::string_view name);

/// Converts the numbers of a time field into seconds relative to `utime` (microseconds). A unit in the name
/// determines the interpretation, otherwise the kind does; if several are possible, the one that puts the
/// points nearest to the stamp is used. An interpretation is accepted only when the points span at most 10 s
/// and lie at most 10 s from the stamp; otherwise `seconds` is empty, since wrong times are worse than none.
/// With utime <= 0, times since the epoch are taken relative to the earliest point. Returns a sentence that
/// states how the field was interpreted, or why it was ignored.
std::string interpret_times(std::string_view name, TimeKind kind, std::int64_t utime,
                            const std::vector<double>& raw, std::vector<float>& seconds);

}  // namespace scanlock
