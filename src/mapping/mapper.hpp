// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "mapping/loop_closure.hpp"
#include "mapping/map_worker.hpp"
#include "mapping/pose_graph.hpp"
#include "mapping/pose_history.hpp"
#include "mapping/submap.hpp"
#include "mapping/submap_join.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// A tracker whose archived keyframes are the nodes of pose graphs, one per submap. A robot that is lost for
/// more than new_map_after_s begins a new submap; its newest keyframe is searched for in the other submaps,
/// and where two searches agree both submaps become one, in the frame of the older. The newest keyframe is
/// aligned with keyframes of an earlier visit nearby; two such loop closures in a row that agree become
/// constraints, the graph is optimised, and the result is applied between two scans. Of two keyframes of one
/// place whose relative pose is known the older one is kept, or the newer one where the place has changed: so
/// the map grows by new ground only. Keyframes of a fixed map are no nodes: constraints to them lead to
/// kOriginNode. Like the tracker, a pure function of its state, the scans and the answers.
class Mapper {
 public:
  explicit Mapper(const TrackerConfig& config) : tracker_(config), joins_(config.search_cores) {}

  TrackedScan track(const Scan& scan, const ScanPrior& prior = {});

  /// The next request, if any: see Tracker. There is no other one before its answer. After load() the first
  /// requests describe the targets of later searches: answered before the first scan, they make these
  /// searches faster.
  std::optional<MapRequest> take_request();
  void give(MapAnswer answer);

  void set_stage_observer(std::function<void(Stage)> observer) {
    tracker_.set_stage_observer(std::move(observer));
  }
  void reset();
  void set_pose(const Pose& map_from_body);
  SavedMap save() const;
  /// `fixed`: keyframes of the map neither move nor are replaced, and constraints connect new ones to them;
  /// submaps that no constraint connects to the map's frame are left out.
  void load(SavedMap saved, bool fixed = false);
  PointCloud map() const { return tracker_.map(); }

  /// From now on each pose has a stamp, by which correction() returns its later correction.
  void keep_history() { history_.emplace(); }
  /// See PoseHistory::correction. The identity without keep_history().
  Pose correction(std::uint32_t stamp) const;

  /// The graph of the active submap: kOriginNode and the keyframes that are not fixed, in the map's frame.
  const PoseGraph& graph() const { return active_.graph; }
  /// Submaps whose pose relative to the active one is not known.
  std::size_t other_submaps() const { return others_.size(); }

 private:
  static constexpr auto kTrail =
      static_cast<std::uint32_t>(1 / kPlaceSpacing);  ///< keyframes along a path of one reach
  /// Information: before the first closure every closure is worth its cost.
  static constexpr double kAnyClosure = 1e12;
  std::uint32_t stamp();
  void prepare_searches();
  void begin_submap();
  void return_to_submap(TrackedScan* tracked);
  void enter(std::size_t other);
  void forget_revisits();
  void follow_archive();
  void drop_evicted();
  void drop_redundant();
  void drop_redundant(std::uint32_t id, const Revisit& revisit);
  void connect_odometry(const ArchivedKeyframe& keyframe);
  std::optional<ClosureRequest> closure_request();
  ClosureRequest request_around(const ArchivedKeyframe& keyframe) const;
  std::optional<JoinRequest> join_request();
  std::vector<Revisit> new_revisits() const;
  void note_revisits(const std::vector<Revisit>& revisits);
  void take_closure(const ClosureAnswer& answer);
  void take_join(const JoinAnswer& answer);
  void bend(const ClosureAnswer& answer, const Pose& own_from_fixed);
  Matrix6 seen_from_robot(std::uint32_t keyframe, const Matrix6& covariance) const;

  Tracker tracker_;
  Submap active_;                         ///< where the robot is; its own_from_map is that of the tracker
  std::vector<Submap> others_;            ///< in no order
  std::uint32_t submap_ = 0;              ///< Tracker::submap() of the active one
  std::vector<SearchTarget> unprepared_;  ///< in reverse order of their requests
  bool located_ = true;  ///< false: a map was loaded, and the robot has not been found in it so far
  JoinSearch joins_;     ///< searches for the active submap in the other ones
  std::optional<PoseHistory> history_;
  struct Open {
    std::uint32_t stamp = 0;
    Pose map_from_local = Pose::Identity();
  };
  std::optional<Open> open_;  ///< the stamp of poses of a lost robot, until it is found
  std::uint32_t known_ = 0;   ///< keyframes with smaller ids were added to the graph
  std::int64_t serial_ = 0;
  bool out_ = false;
  /// The last keyframe that was considered for a closure, and for which one was requested.
  std::uint32_t considered_ = 0, asked_ = 0;
  /// The last keyframes that no answer has named as revisits, each with the stamp of the oldest keyframe of
  /// its visit.
  std::map<std::uint32_t, std::int64_t> unnamed_;
  std::optional<Constraint> pending_;  ///< the last closure, until the next one agrees
  Matrix6 usual_information_ = kAnyClosure * Matrix6::Identity();  ///< of the last closure
  std::map<std::uint32_t, Revisit> revisits_;  ///< by keyframe, until drop_redundant() has decided
  /// A correction, or the result of a search of other submaps, that is published with the next scan.
  std::optional<Recovery> correction_;
  int closures_ = 0;
};

}  // namespace scanlock
