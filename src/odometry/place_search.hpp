// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "odometry/keyframe_archive.hpp"
#include "odometry/recovery.hpp"
#include "odometry/surroundings.hpp"

namespace scanlock {

/// Number of scales of the searches, which take turns: places that look alike on one scale seldom do so on
/// another.
inline constexpr int kSearchScales = 2;

/// The order of the searches for a lost robot: around its last trusted pose, again when it has seen more,
/// then alternately there and around all other keyframes, those of the most similar signature first, with
/// increasing pauses.
class PlaceSearch {
 public:
  /// Size of the parts of the map that are searched where the robot is not expected at a certain place.
  enum class Parts {
    kWide,   ///< kWidestPart: all places that look alike are hypotheses of one search
    kNarrow  ///< searched one after another, so that each place that looks alike is found
  };
  /// `cores`: CPU cores that searches may use, averaged over a minute.
  PlaceSearch(double cores, Parts parts)
      : cores_(cores), credit_s_(kWindow * cores), wide_(parts == Parts::kWide) {}

  /// The targets, in wide parts, of the first searches for a robot that was never localised in this map.
  /// Empty where there would be more than a PlaceFinder remembers.
  static std::vector<SearchTarget> first_targets(const KeyframeArchive& archive);

  /// The robot was lost at `anchor` (map frame); nullopt: its place is unknown.
  void begin(const std::optional<Eigen::Vector3d>& anchor);
  /// Discards what the robot has seen so far: the next request waits for new scans, and the answer to an
  /// earlier one is too late.
  void begin_anew();

  /// Whether a request may be made once the robot has seen so many scans.
  bool is_due(int scans) const { return !out_ && scans >= scans_wanted_; }
  /// The next request, when enough was seen for it and none is unanswered. `utime`: microseconds. `up`:
  /// upward direction in the map frame, where it was measured.
  std::optional<RecoveryRequest> next(std::int64_t utime, const Surroundings& seen,
                                      const KeyframeArchive& archive,
                                      const std::optional<Eigen::Vector3d>& up);
  /// Takes note of an answer, which cost `cost_s` seconds of CPU; false when it is too late. If a place was
  /// `found`, the next search, of another scale, is due soon, and in the same part of the map, unless that
  /// part was chosen only for its likeness and shows `little` of what was seen.
  bool take(std::int64_t serial, bool found, bool little, double cost_s);
  bool looked_everywhere() const { return turn_ >= 2 && turn_ >= round_; }

 private:
  /// A part of the map.
  struct Part {
    Eigen::Vector3d centre;
    double scene;     ///< metres, the mean reach of the keyframes there
    double likeness;  ///< 0 to 1: largest similarity of its keyframes to what was seen
  };
  static std::vector<Part> parts_of(const KeyframeArchive& archive, bool wide,
                                    const std::optional<Eigen::Vector3d>& anchor, const PlaceSignature* seen);
  bool has_credit(std::int64_t utime);

  static constexpr double kWindow = 60;  ///< seconds, over which the use of CPU is averaged
  double cores_, credit_s_;              ///< the latter: seconds of CPU left; at 0 or below no search begins
  std::int64_t credited_utime_ = 0;      ///< up to which credit was added, microseconds
  bool wide_;
  std::optional<Eigen::Vector3d> anchor_;
  std::vector<Part> others_;  ///< parts away from the anchor, in the order of the searches
  std::int64_t serial_ = 0;
  bool out_ = false, void_ = false;  ///< a request is unanswered; its answer will be ignored
  int attempts_ = 0;                 ///< searches answered since the robot was lost
  bool elsewhere_ = false;           ///< the request is for a part away from the anchor
  int turn_ = 0;                     ///< number of parts of the map that are done
  int round_ = 2;                    ///< turns in which each part is searched once
  int scans_asked_ = 0;              ///< scans seen at the last request
  int scans_wanted_ = 0;             ///< scans to be seen before the next request
};

}  // namespace scanlock
