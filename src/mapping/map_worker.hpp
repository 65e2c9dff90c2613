// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <variant>

#include "mapping/loop_closure.hpp"
#include "mapping/submap_join.hpp"
#include "odometry/place_search.hpp"
#include "odometry/recovery.hpp"
#include "odometry/tracker_config.hpp"

namespace scanlock {

/// Work that need not be done before the next scan: a search for the robot's pose; the description of a
/// search target ahead of its searches; a loop closure; or a search for the active submap in the other
/// submaps.
using MapRequest = std::variant<RecoveryRequest, SearchTarget, ClosureRequest, JoinRequest>;
/// std::monostate: a search target was described.
using MapAnswer = std::variant<std::monostate, RecoveryAnswer, ClosureAnswer, JoinAnswer>;

/// Works on a request; deterministic. Where points of the map cannot be read the answer is "not found" and
/// names the fault: see TrackedScan::map_fault.
class MapWorker {
 public:
  explicit MapWorker(const TrackerConfig& config) : config_(config) {}
  MapAnswer work(const MapRequest& request);

 private:
  TrackerConfig config_;
  PlaceFinder finder_;
};

}  // namespace scanlock
