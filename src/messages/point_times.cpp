// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/point_times.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scanlock {
namespace {

constexpr double kMaxSecondsFromStamp = 10.0;  // longer than any scan

/// One interpretation of the numbers: seconds = (number - origin) * scale.
struct Reading {
  double scale = 1;   ///< seconds per unit
  double origin = 0;  ///< in units
  const char* words = "";
};

struct Unit {
  std::string_view suffix;
  double scale;
  const char* relative;
  const char* absolute;
};
constexpr Unit kUnits[] = {
    {"s", 1, "seconds after the stamp", "seconds since the epoch"},
    {"ms", 1e-3, "milliseconds after the stamp", "milliseconds since the epoch"},
    {"us", 1e-6, "microseconds after the stamp", "microseconds since the epoch"},
    {"ns", 1e-9, "nanoseconds after the stamp", "nanoseconds since the epoch"},
};
constexpr const Unit& kSeconds = kUnits[0];
constexpr const Unit& kMicroseconds = kUnits[2];
constexpr const Unit& kNanoseconds = kUnits[3];

std::string lower(std::string_view name) {
  std::string result(name);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// Removes the unit from the name: "time_offset_ns" becomes "time_offset". Null when the name has none.
const Unit* split_unit(std::string& name) {
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string::npos) return nullptr;
  std::string suffix = name.substr(underscore + 1);
  if (suffix == "sec" || suffix == "msec" || suffix == "usec" || suffix == "nsec")
    suffix.resize(suffix.size() - 2);
  for (const Unit& unit : kUnits)
    if (suffix == unit.suffix) {
      name.resize(underscore);
      return &unit;
    }
  return nullptr;
}

/// Seconds between instant 0 and the interval [first, last]; 0 when it lies inside.
double distance_to_interval(double first, double last) {
  return std::max({first, -last, 0.0});
}

class ReadingChoice {
 public:
  ReadingChoice(double smallest, double largest, std::int64_t utime)
      : smallest_(smallest), largest_(largest), utime_(utime) {}

  void consider_relative(const Unit& unit) { consider({unit.scale, 0, unit.relative}); }
  void consider_absolute(const Unit& unit) {
    const double year_2001 = 1e9,
                 year_2096 = 4e9;  // without a stamp, accept only values that are certainly since the epoch
    const bool surely_epoch = smallest_ * unit.scale > year_2001 && largest_ * unit.scale < year_2096;
    if (utime_ > 0)
      consider({unit.scale, static_cast<double>(utime_) * 1e-6 / unit.scale, unit.absolute});
    else if (surely_epoch)
      consider({unit.scale, smallest_, unit.absolute});
  }
  const Reading* best() const { return distance_ <= kMaxSecondsFromStamp ? &best_ : nullptr; }

 private:
  void consider(const Reading& reading) {
    const double first = (smallest_ - reading.origin) * reading.scale;
    const double last = (largest_ - reading.origin) * reading.scale;
    const double distance = distance_to_interval(first, last);
    if (!(last - first <= kMaxSecondsFromStamp) || !(distance < distance_)) return;
    best_ = reading;
    distance_ = distance;
  }

  double smallest_, largest_;
  std::int64_t utime_;
  Reading best_;
  double distance_ = std::numeric_limits<double>::infinity();
};

void consider_readings(ReadingChoice& choice, const Unit* named, TimeKind kind) {
  if (kind == TimeKind::kMicrosecondsOfEpoch) {
    choice.consider_absolute(kMicroseconds);
  } else if (named != nullptr) {
    choice.consider_relative(*named);
    if (kind == TimeKind::kFloat64) choice.consider_absolute(*named);
  } else if (kind == TimeKind::kInteger) {
    choice.consider_relative(kNanoseconds);
  } else {
    choice.consider_relative(kSeconds);
    if (kind == TimeKind::kFloat64)
      for (const Unit& unit : kUnits) choice.consider_absolute(unit);
  }
}

}  // namespace

std::optional<int> time_name_rank(std::string_view name) {
  constexpr std::array<std::string_view, 13> kNames = {
      "t",          "time",     "offset_time",   "time_offset", "timestamp",
      "time_stamp", "rel_time", "relative_time", "point_time",  "dt",
      "ts",         "stamp",    "timeoffset"};
  if (name.size() > 32) return std::nullopt;
  std::string base = lower(name);
  for (int pass = 0; pass < 2; ++pass) {
    const auto found = std::find(kNames.begin(), kNames.end(), base);
    if (found != kNames.end()) return static_cast<int>(found - kNames.begin());
    if (split_unit(base) == nullptr) break;
  }
  return std::nullopt;
}

std::string interpret_times(std::string_view name, TimeKind kind, std::int64_t utime,
                            const std::vector<double>& raw, std::vector<float>& seconds) {
  seconds.clear();
  if (raw.empty()) return {};
  const std::string quoted = "`" + std::string(name) + "`";
  double smallest = raw.front(), largest = raw.front();
  for (const double value : raw) {
    if (!std::isfinite(value)) return quoted + " is ignored: it holds values that are not finite";
    smallest = std::min(smallest, value);
    largest = std::max(largest, value);
  }
  std::string base = lower(name);
  const Unit* named = split_unit(base);
  ReadingChoice choice(smallest, largest, utime);
  consider_readings(choice, named, kind);
  const Reading* reading = choice.best();
  if (reading == nullptr)
    return quoted + " is ignored: its values, " + std::to_string(smallest) + " to " +
           std::to_string(largest) +
           ", are neither relative to the stamp nor near it (append the unit to the name: _s, _us, _ns)";
  seconds.resize(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i)
    seconds[i] = static_cast<float>((raw[i] - reading->origin) * reading->scale);
  return quoted + " in " + reading->words;
}

}  // namespace scanlock
