// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"
#include "odometry/excursion.hpp"
#include "odometry/odometer.hpp"
#include "odometry/recovery.hpp"

namespace scanlock {

/// What an alignment says for a place rather than for ground that the map does not show, in log odds without
/// a bound, by its energy beyond the usual one.
double log_odds_of_energy(double more);

/// A sequential test of hypotheses, corrections of the predicted pose of a lost robot, on the scans that
/// follow. A hypothesis wins when it explains three scans in a row with its share of the usual inliers (0.3
/// of them where searches believe it, otherwise 0.9 of them, or of those of the best hypothesis if these are
/// less) while every other one is refuted or clearly worse, and leaves no horizontal direction open. The test
/// is undecided when no single hypothesis has won after a fixed number of scans.
class Contest {
 public:
  enum class Outcome { kOpen, kWon, kRefuted, kUndecided };

  /// Corrections of predicted poses: first the one that searches believe, which the map need not show all of.
  /// `maps`: of each hypothesis an odometer in the map around it; where there are none, the map of the
  /// odometer of judge() shows all of them. In one map for all, a hypothesis beside another would be shown by
  /// the keyframes of both, and explain more.
  explicit Contest(const std::vector<Pose>& map_from_predicted,
                   std::vector<std::unique_ptr<Odometer>> maps = {});
  /// A single hypothesis at which the robot is expected, without a search. `wins`: scans that it has
  /// explained already.
  static Contest expected_at(const Pose& map_from_predicted, int wins);

  /// The hypothesis near this correction is not contradicted, though the map may not show all that is seen
  /// there.
  void note_standing(const Pose& map_from_predicted, const Excursion& excursion);

  /// The hypotheses have maps of their own.
  bool is_elsewhere() const { return places_.front().map != nullptr; }
  /// Tests one more scan, which the excursion has followed. The test goes on while the outcome is kOpen, and
  /// may go on after kWon.
  Outcome judge(Odometer& odometer, const PreparedScan& scan, const Excursion& excursion);
  /// It has had all the scans in which it has to be decided.
  bool is_spent() const;

  /// What the scans add to the log odds that the best hypothesis is the robot's place rather than ground that
  /// the map does not show, up to kMostOfScans: by the energy of the last one beyond the usual one, and the
  /// more, the more surfaces that stand up they meet there. Level ground fits everywhere. 0 where no scan was
  /// aligned before.
  double log_odds() const;

  /// The reason of kUndecided, in words.
  const char* why_undecided() const;

  /// The alignment of the last scan at the best hypothesis.
  const Attempt& attempt() const { return places_.front().attempt; }
  const Pose& map_from_predicted() const { return places_.front().map_from_predicted; }
  /// All hypotheses that are not refuted, the best first.
  std::vector<Pose> places() const;

 private:
  struct Place {
    Pose map_from_predicted;
    std::unique_ptr<Odometer> map;  ///< null: that of judge()
    double least_share = 0;         ///< of the usual share of inliers, to fit
    int missed = 0;
    bool fits = false;        ///< the last scan
    bool tried = false;       ///< it has fitted
    bool looked_far = false;  ///< or was looked for farther off
    Attempt attempt;
    std::vector<PointMatch> point_matches;  ///< of the last scan
    struct Patch {
      double known = 0, explained = 0, steep = 0;  ///< points of the scans, see PointMatch
      double off() const { return known - explained; }
    };
    std::vector<Patch> patches;
    double explained() const;                              ///< points of all patches
    bool is_due() const { return !tried && !looked_far; }  ///< before that it cannot be out
    /// How far off it may be: standard deviations.
    double near_metres() const { return tried ? 0.1 : 0.5; }
    double near_radians() const { return (tried ? 2.0 : 3.0) * kDegree; }
  };
  bool fits(const Attempt& attempt, const Place& place, double most) const;
  void look_near(Odometer& odometer, const PreparedScan& scan, const Excursion& excursion,
                 Place& place) const;
  void try_place(Odometer& odometer, const PreparedScan& scan, const Excursion& excursion, double most,
                 int* far_looks, Place& place) const;
  void note_explained(const PreparedScan& scan, const Pose& predicted, bool anew);
  bool is_worse(const Place& place, const Place& other) const;
  void drop_losers(const Pose& predicted);

  std::vector<Place> places_;  ///< never empty; the leader first
  /// Cubes of the predicted frame, by their Morton keys: the points of one share what is wrong with them.
  std::map<std::uint64_t, std::size_t> patches_;
  std::vector<double> points_;  ///< in each patch, of the scans since all places were looked for well
  double patch_ = 0;            ///< metres, their edge
  int wins_ = 0, scans_ = 0;
  bool expected_ = false;
};

}  // namespace scanlock
