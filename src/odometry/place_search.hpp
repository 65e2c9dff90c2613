// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "odometry/keyframe_archive.hpp"
#include "odometry/recovery.hpp"
#include "odometry/surroundings.hpp"

namespace scanlock {

/// Scales on which a place is looked for, by turns: what looks alike on one seldom does so on another.
inline constexpr int kSearchScales = 2;

/// The order of the searches for a lost robot: around its last trusted pose, again when it has seen more,
/// then by turns there and around all other keyframes, those of the most similar signature first, with ever
/// longer pauses.
class PlaceSearch {
 public:
  /// Parts of the map in which a robot is looked for that nobody expects at a certain place.
  enum class Parts {
    kWide,   ///< kWidestPart: all places that look alike are rivals in one search
    kNarrow  ///< one after another, so that each place that looks alike is found
  };
  /// `cores`: of the CPU, what searches may take in the mean of a minute.
  PlaceSearch(double cores, Parts parts)
      : cores_(cores), credit_s_(kWindow * cores), wide_(parts == Parts::kWide) {}

  /// The targets of the first searches for a robot that nobody has seen in this map, in wide parts. None
  /// where there are more than a PlaceFinder remembers.
  static std::vector<SearchTarget> first_targets(const KeyframeArchive& archive);

  /// The robot was lost at `anchor` (map frame); none: nobody knows where.
  void begin(const std::optional<Eigen::Vector3d>& anchor);
  /// What it has seen so far is void: the next request waits for more, and the answer to an earlier one is
  /// too late.
  void begin_anew();

  /// Whether there may be a request once so many scans were seen.
  bool is_due(int scans) const { return !out_ && scans >= scans_wanted_; }
  /// The next request, when enough was seen for it and none is out. `up`: in the map frame, where that was
  /// measured.
  std::optional<RecoveryRequest> next(std::int64_t utime, const Surroundings& seen,
                                      const KeyframeArchive& archive,
                                      const std::optional<Eigen::Vector3d>& up);
  /// The answer to a request came in, and cost so many seconds; false when it is too late. Where there is
  /// something the next look, of another scale, is soon, and at the same part of the map, unless that was
  /// only chosen for its likeness and shows `little` of what was seen.
  bool take(std::int64_t serial, bool found, bool little, double cost_s);
  bool looked_everywhere() const { return turn_ >= 2 && turn_ >= round_; }

 private:
  /// Of the map.
  struct Part {
    Eigen::Vector3d centre;
    double scene;     ///< metres, the mean reach there
    double likeness;  ///< 0 to 1: how much it looks like what was seen
  };
  static std::vector<Part> parts_of(const KeyframeArchive& archive, bool wide,
                                    const std::optional<Eigen::Vector3d>& anchor, const PlaceSignature* seen);
  bool has_credit(std::int64_t utime);

  static constexpr double kWindow = 60;  ///< seconds
  double cores_, credit_s_;              ///< the latter of CPU; below 0 no search begins
  std::int64_t credited_utime_ = 0;      ///< up to when
  bool wide_;
  std::optional<Eigen::Vector3d> anchor_;
  std::vector<Part> others_;  ///< in the order in which they are looked at
  std::int64_t serial_ = 0;
  bool out_ = false, void_ = false;
  int attempts_ = 0;        ///< answered since the robot was lost
  bool elsewhere_ = false;  ///< the request: away from the anchor
  bool rough_ = false;      ///< the request: the ground may make the body stand in ways it never did there
  bool careful_ = false;    ///< a search that does not allow for that has found nothing
  int turn_ = 0;            ///< parts of the map done with
  int round_ = 2;           ///< turns that look everywhere once
  int scans_asked_ = 0;     ///< that were seen at the last request,
  int scans_wanted_ = 0;    ///< and have to be for the next one
};

}  // namespace scanlock
