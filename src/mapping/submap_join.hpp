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

/// A hypothesis of how two submaps lie to each other: a keyframe of the active submap, found in another
/// submap.
struct JoinResult {
  Constraint closure;  ///< from a node of the other submap to the keyframe
  std::uint32_t nearest_keyframe = 0;
  double log_odds = 0;  ///< that the find is right, by the search alone
};

/// A search for the active submap's newest keyframe in all other submaps. A value: another thread can work on
/// it.
struct JoinRequest {
  RecoveryRequest search;  ///< for the surroundings of the keyframe, in the other submaps
  ClosureRequest closure;  ///< `keyframe` and `recent`; `earlier` and `nearest` are not used
  Submap active;
  std::vector<Submap> others;
  std::vector<JoinResult> finds;  ///< earlier finds of this active submap
};

struct JoinAnswer {
  RecoveryAnswer search;
  /// kPending: found; kAccepted: enough finds agree, and the joined graph was optimised.
  ClosureAnswer closure;
  std::size_t other = 0;             ///< index of the submap in JoinRequest::others
  std::vector<Constraint> agreeing;  ///< the earlier finds that agree on the relative pose
};

/// Finds the keyframe's pose by certified search and aligns the keyframe there. Accepts the join when an
/// earlier find, of another keyframe, agrees on the relative pose of the two submaps, and the log odds of the
/// agreeing finds together and of the prior, less up to kMostOfScans for excess energy of the alignment,
/// reach kBelieved.
JoinAnswer join_submaps(const JoinRequest& request, PlaceFinder& finder, const TrackerConfig& config);

/// Schedules the searches of the other submaps, and stores their finds.
class JoinSearch {
 public:
  /// `cores`: see PlaceSearch.
  explicit JoinSearch(double cores) : search_(cores, PlaceSearch::Parts::kNarrow) {}

  /// The active submap has changed: discards the finds.
  void begin();
  /// A scan was aligned with the active submap.
  void note_scan() { ++scans_; }
  /// Whether to search the other submaps for this keyframe; to be called once per keyframe.
  bool is_due(std::uint32_t newest);
  /// The next search, where the CPU budget allows it. `elsewhere`: the keyframes of the other submaps;
  /// `scene`: see Surroundings.
  std::optional<RecoveryRequest> next(std::int64_t utime, const LocalMap& map, const Pose& map_from_body,
                                      double scene, const KeyframeArchive& elsewhere);
  /// To be called with every answer.
  void take(const JoinAnswer& answer);
  void remember(const JoinResult& find);
  const std::vector<JoinResult>& finds() const { return search_results_; }

 private:
  PlaceSearch search_;
  int scans_ = 0;
  std::uint32_t asked_ = 0;                 ///< the last keyframe of is_due()
  std::vector<JoinResult> search_results_;  ///< the newest comes first
};

}  // namespace scanlock
