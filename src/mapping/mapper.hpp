// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "mapping/loop_closure.hpp"
#include "mapping/pose_graph.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// Work that need not be done before the next scan: a search for the robot's place, or a loop closure.
using MapRequest = std::variant<RecoveryRequest, ClosureRequest>;
using MapAnswer = std::variant<RecoveryAnswer, ClosureAnswer>;

/// Does that work; deterministic.
class MapWorker {
 public:
  explicit MapWorker(const TrackerConfig& config) : config_(config) {}
  MapAnswer work(const MapRequest& request);

 private:
  TrackerConfig config_;
  PlaceFinder finder_;
};

/// A tracker whose archived keyframes are the nodes of a pose graph. Where the robot comes to ground that an
/// earlier visit saw, the newest keyframe is aligned with what was seen then; two such loop closures in a row
/// that agree become constraints, and the map is bent to them between two scans.
/// As the tracker, a pure function of its state, the scans and the answers.
class Mapper {
 public:
  explicit Mapper(const TrackerConfig& config) : tracker_(config) {}

  TrackedScan track(const Scan& scan, const ScanPrior& prior = {});

  /// The work that it would like to have done now, if any: see Tracker. One is out at a time.
  std::optional<MapRequest> take_request();
  void give(MapAnswer answer);

  void set_stage_observer(std::function<void(Stage)> observer) {
    tracker_.set_stage_observer(std::move(observer));
  }
  void reset();
  void set_pose(const Pose& map_from_body) { tracker_.set_pose(map_from_body); }
  SavedMap save() const { return tracker_.save(); }
  void load(SavedMap saved);
  PointCloud map() const { return tracker_.map(); }

  const PoseGraph& graph() const { return graph_; }
  /// Frame of graph().nodes() is the map's.
  int closures() const { return closures_; }

 private:
  void follow_archive();
  std::optional<ClosureRequest> closure_request();
  void take_closure(const ClosureAnswer& answer);
  bool agree(const Constraint& a, const Constraint& b) const;
  void bend();
  Matrix6 drift_at(std::uint32_t keyframe) const;

  Tracker tracker_;
  PoseGraph graph_;
  std::uint32_t known_ = 0;  ///< keyframes of smaller ids were added to the graph
  std::int64_t serial_ = 0;
  bool out_ = false;
  std::optional<std::uint32_t> asked_;  ///< the last keyframe that a closure was asked for
  std::optional<Constraint> pending_;   ///< of the keyframe before, until another one agrees
  Matrix6 told_ = Matrix6::Zero();      ///< covariance of the last closure that was believed
  std::optional<Recovery> correction_;  ///< to be told with the next scan
  int closures_ = 0;
};

}  // namespace scanlock
