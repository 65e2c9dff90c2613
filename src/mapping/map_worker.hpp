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

/// Work that need not be done before the next scan: a search for the robot's place, a target of such searches
/// described ahead, a loop closure, or a search for the active submap's place among others.
using MapRequest = std::variant<RecoveryRequest, SearchTarget, ClosureRequest, JoinRequest>;
/// Of a target that was described there is nothing to tell.
using MapAnswer = std::variant<std::monostate, RecoveryAnswer, ClosureAnswer, JoinAnswer>;

/// Works on a request; deterministic. Where points cannot be read, nothing is found: see
/// TrackedScan::map_fault.
class MapWorker {
 public:
  explicit MapWorker(const TrackerConfig& config) : config_(config) {}
  MapAnswer work(const MapRequest& request);

 private:
  TrackerConfig config_;
  PlaceFinder finder_;
};

}  // namespace scanlock
