// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/log_states.hpp"

#include <algorithm>

#include "io/lcm_log.hpp"
#include "io/log_poses.hpp"
#include "io/trajectory_source.hpp"
#include "messages/decode_report.hpp"

namespace scanlock {

std::vector<StampedState> load_states(const std::string& source, const std::string& channel) {
  const std::string path = trajectory_file(source);
  std::vector<StampedState> states;
  if (!is_log(path)) return states;
  LogReader reader(path);
  while (const auto event = reader.next()) {
    if (event->channel != channel) continue;
    const auto decoded = decode_odometry(event->data.data(), event->data.size());
    if (!decoded.ok()) continue;
    const TrackedScan& tracked = decoded.value.tracked;
    states.push_back({static_cast<double>(tracked.utime) * 1e-6, tracked.state, tracked.epoch,
                      tracked.degenerate_axes, tracked.map_from_body, tracked.covariance});
  }
  std::stable_sort(states.begin(), states.end(),
                   [](const StampedState& a, const StampedState& b) { return a.time_s < b.time_s; });
  return states;
}

const StampedState* said_at(const std::vector<StampedState>& states, double time_s) {
  const auto found =
      std::lower_bound(states.begin(), states.end(), time_s - kSameTime,
                       [](const StampedState& state, double time) { return state.time_s < time; });
  return found == states.end() || found->time_s > time_s + kSameTime ? nullptr : &*found;
}

}  // namespace scanlock
