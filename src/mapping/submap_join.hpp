// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/loop_closure.hpp"
#include "mapping/submap.hpp"
#include "odometry/place_search.hpp"
#include "odometry/recovery.hpp"

namespace scanlock {

/// A keyframe of the active submap that was found in another submap.
struct JoinFind {
  Constraint closure;  ///< to the keyframe
  std::uint32_t nearest_keyframe = 0;
  double log_odds = 0;  ///< by the search
};

/// A search for the active submap's newest keyframe in all other submaps. A value: it can be worked on by
/// another thread.
struct JoinRequest {
  RecoveryRequest search;  ///< of what is around the keyframe, in the other submaps
  ClosureRequest closure;  ///< `recent` is around the keyframe; there is no `earlier`, nor `nearest`
  Submap active;
  std::vector<Submap> others;
  std::vector<JoinFind> finds;  ///< earlier ones, of this active submap
};

struct JoinAnswer {
  RecoveryAnswer search;
  ClosureAnswer closure;  ///< kPending: found; kAccepted: enough finds agree, and both submaps are one
  std::size_t other = 0;  ///< place of the submap, among the others
  std::vector<Constraint> agreeing;  ///< of an accepted one: the earlier finds that say the same
};

/// Finds the keyframe's pose by certified search, aligns it there, and accepts the join when an earlier find,
/// of another keyframe, agrees on the relative pose of the two submaps, and the searches together, less what
/// the energy of the alignment says against it, are believed (for a planar sensor, when three earlier finds
/// agree).
JoinAnswer join_submaps(const JoinRequest& request, PlaceFinder& finder, const TrackerConfig& config);

/// Schedules the searches of the other submaps, and keeps their finds.
class JoinSearch {
 public:
  /// `cores`: see PlaceSearch.
  explicit JoinSearch(double cores) : search_(cores, PlaceSearch::Parts::kNarrow) {}

  /// The active submap is another one: the finds are void.
  void begin();
  /// A scan was aligned with the active submap.
  void note_scan() { ++scans_; }
  /// Whether to search the other submaps for this keyframe; to be asked once for each.
  bool is_due(std::uint32_t newest);
  /// The search, where the budget allows it. `elsewhere`: the keyframes of the other submaps;
  /// `scene`: see Surroundings.
  std::optional<RecoveryRequest> next(std::int64_t utime, const LocalMap& map, const Pose& map_from_body,
                                      double scene, const KeyframeArchive& elsewhere);
  /// Of every answer.
  void take(const JoinAnswer& answer);
  void remember(const JoinFind& find);
  const std::vector<JoinFind>& finds() const { return finds_; }

 private:
  PlaceSearch search_;
  int scans_ = 0;
  std::uint32_t asked_ = 0;      ///< keyframe
  std::vector<JoinFind> finds_;  ///< the newest first
};

}  // namespace scanlock
