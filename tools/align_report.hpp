// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// What the reports of scanlock-align are made of.
#pragma once

#include <sys/resource.h>

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

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

inline double peak_rss_mb() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) * 1024e-6;  // of kibibytes
}

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

/// The object on one line; or, for people, the transform on standard output and the rest, but for long lists,
/// on standard error.
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
    if (!value.is_array() || value.size() < kLong) std::cerr << key << ": " << value.dump() << "\n";
  }
}

}  // namespace scanlock
