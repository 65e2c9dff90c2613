// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Functions for the reports of scanlock-align.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "command_line.hpp"
#include "geometry/moved_cloud.hpp"

namespace scanlock {

using Json = nlohmann::ordered_json;

class Stopwatch {
 public:
  /// Milliseconds since the last lap.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

inline Json row_major(const Eigen::MatrixXd& matrix) {
  Json values = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) values.push_back(matrix(r, c));
  }
  return values;
}

inline Json axis_names(std::uint32_t axes) {
  constexpr const char* kNames[] = {"x", "y", "z", "rx", "ry", "rz"};
  Json names = Json::array();
  for (int bit = 0; bit < 6; ++bit) {
    if (axes >> bit & 1u) names.push_back(kNames[bit]);
  }
  return names;
}

/// The name and the unit of a member of the JSON object in the report for people; members without a label go
/// by their keys.
struct Label {
  const char *key, *name, *unit;
};
constexpr Label kLabels[] = {{"points", "points (source, target)", ""},
                             {"voxel", "thinned to", "m"},
                             {"stop_reason", "stop reason", ""},
                             {"nu", "scale of residuals", "m"},
                             {"searches", "nearest-point searches", ""},
                             {"degenerate_axes", "degenerate axes", ""},
                             {"ms", "time", "ms"},
                             {"peak_rss_mb", "peak memory", "MB"},
                             {"epsilon", "inlier threshold", "m"},
                             {"tilt_deg", "tilt", "deg"},
                             {"rmse", "rmse to the truth", "m"},
                             {"rotation_error_deg", "rotation error", "deg"},
                             {"translation_error", "translation error", "m"}};

inline std::string with_blanks(std::string name) {
  for (char& c : name) c = c == '_' ? ' ' : c;
  return name;
}

/// A value as text: numbers that are no integers with four digits, lists and objects on one line.
inline std::string words_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_null()) return "unknown";
  if (value.is_number_float()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value.get<double>());
    return text;
  }
  if (!value.is_structured()) return value.dump();
  std::string words;
  for (const auto& [key, member] : value.items()) {
    if (!words.empty()) words += ", ";
    if (value.is_object()) words += with_blanks(key) + " ";
    words += words_of(member);
  }
  return words.empty() ? "none" : words;
}

inline void print_labelled(const std::string& key, const Json& value) {
  std::string name = with_blanks(key), unit;
  for (const Label& label : kLabels) {
    if (key != label.key) continue;
    name = label.name;
    unit = label.unit;
  }
  std::fprintf(stderr, "%-24s %s%s\n", name.c_str(), words_of(value).c_str(),
               unit.empty() ? "" : (" " + unit).c_str());
}

/// Prints the JSON object on one line; or, for people, the transform on standard output and all other
/// members, except long lists, on standard error.
inline void print_result(const Json& json, bool as_json) {
  if (as_json) {
    print_json(json);
    return;
  }
  const auto& t = json["transform"];
  for (std::size_t row = 0; row < 4; ++row) {
    std::printf("%.9g %.9g %.9g %.9g\n", t[4 * row].get<double>(), t[4 * row + 1].get<double>(),
                t[4 * row + 2].get<double>(), t[4 * row + 3].get<double>());
  }
  constexpr std::size_t kLong = 12;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_array() || value.size() < kLong) print_labelled(key, value);
  }
}

}  // namespace scanlock
