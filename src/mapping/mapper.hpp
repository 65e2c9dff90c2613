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

/// A tracker whose archived keyframes are the nodes of pose graphs, one a submap. A robot that is lost for
/// long begins a new submap; its newest keyframe is searched for in the others, and where two searches agree
/// both submaps become one, in the frame of the older. Near keyframes of an earlier visit the newest one is
/// aligned with them; two such loop closures in a row that agree become constraints, and the graph is
/// optimised, taken over between two scans. Where the relative pose of two visits is known, one keyframe of a
/// place is kept: the older one, unless the place has changed. So the map grows by new ground alone.
/// Keyframes of a map that is fixed are no nodes: what is tied to them is tied to kOriginNode. As the
/// tracker, a pure function of its state, the scans and the answers.
class Mapper {
 public:
  explicit Mapper(const TrackerConfig& config) : tracker_(config), joins_(config.search_cores) {}

  TrackedScan track(const Scan& scan, const ScanPrior& prior = {});

  /// The work that is due, if any: see Tracker. No other is due before its answer. After load() these are the
  /// targets of the searches to come: done before the first scan, they make these faster.
  std::optional<MapRequest> take_request();
  void give(MapAnswer answer);

  void set_stage_observer(std::function<void(Stage)> observer) {
    tracker_.set_stage_observer(std::move(observer));
  }
  void reset();
  void set_pose(const Pose& map_from_body);
  SavedMap save() const;
  /// `fixed`: keyframes of the map neither move nor are replaced, and new ones are tied to them;
  /// submaps that are not tied to its frame are left out.
  void load(SavedMap saved, bool fixed = false);
  PointCloud map() const { return tracker_.map(); }

  /// From now on each pose has a stamp, with which correction() gives its later corrections.
  void keep_history() { history_.emplace(); }
  /// See PoseHistory::correction. The identity where no history is kept.
  Pose correction(std::uint32_t stamp) const;

  /// Of the active submap. Its nodes are kOriginNode and the keyframes that are not fixed, in the map's
  /// frame.
  const PoseGraph& graph() const { return active_.graph; }
  /// Submaps whose pose relative to the active one is not known.
  std::size_t other_submaps() const { return others_.size(); }

 private:
  /// How a keyframe lies to one of an earlier visit.
  struct Revisit {
    std::uint32_t keyframe = 0, nearest = 0;
    std::uint32_t nearest_keyframe = 0;  ///< as `nearest`, but where that is kOriginNode
    Matrix6 covariance = Matrix6::Zero();
  };
  static constexpr auto kTrail =
      static_cast<std::uint32_t>(1 / kPlaceSpacing);  ///< keyframes of one reach of way
  static constexpr double kAnyClosure = 1e12;         ///< before there was one, each is worth its cost
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
  bool is_known(Revisit revisit);
  void note_revisit(const Revisit& revisit);
  void take_closure(const ClosureAnswer& answer);
  void take_join(const JoinAnswer& answer);
  void bend(const ClosureAnswer& answer, const Pose& own_from_fixed);
  Matrix6 seen_from_robot(std::uint32_t keyframe, const Matrix6& covariance) const;

  Tracker tracker_;
  Submap active_;                         ///< where the robot is; where its frame lies the tracker knows
  std::vector<Submap> others_;            ///< in no order
  std::uint32_t submap_ = 0;              ///< as the tracker counts
  std::vector<SearchTarget> unprepared_;  ///< the next one comes last
  bool located_ = true;  ///< false: a map was loaded, and the robot has not been found in it so far
  JoinSearch joins_;     ///< of the active submap with the others
  std::optional<PoseHistory> history_;
  struct Open {
    std::uint32_t stamp = 0;
    Pose map_from_local = Pose::Identity();
  };
  std::optional<Open> open_;  ///< of poses of a lost robot, until it is found
  std::uint32_t known_ = 0;   ///< keyframes of smaller ids were added to the graph
  std::int64_t serial_ = 0;
  bool out_ = false;
  std::uint32_t considered_ = 0, asked_ = 0;  ///< the last keyframes that might have been aligned, and were
  std::uint32_t pending_keyframe_ = 0;        ///< of the earlier visit
  std::optional<Constraint> pending_;         ///< of the keyframe before, until another one agrees
  Matrix6 usual_information_ = kAnyClosure * Matrix6::Identity();  ///< of the last closure
  std::optional<Revisit> last_revisit_;
  std::map<std::uint32_t, Revisit> revisits_;  ///< by keyframe, until it takes the other one's place
  std::optional<Recovery> correction_;  ///< or a search of other submaps, to be told with the next scan
  int closures_ = 0;
};

}  // namespace scanlock
