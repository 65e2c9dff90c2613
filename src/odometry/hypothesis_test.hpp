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
#include "odometry/lost_mode_odometry.hpp"
#include "odometry/odometer.hpp"
#include "odometry/recovery.hpp"

namespace scanlock {

/// Log odds, unbounded, that an alignment is at the robot's place rather than that the map does not cover
/// this hypothesis. `more`: energy of the alignment less its running median.
double log_odds_of_energy(double more);

/// A sequential test of hypotheses, corrections of the predicted pose of a lost robot, on the scan at hand
/// and those that follow. A hypothesis wins when three scans in a row fit at it while every other hypothesis
/// is refuted or clearly worse, and when x, y and yaw are observable. A scan fits if its inlier ratio is at
/// least 0.3 of the running median for the hypothesis that a search supports; for the others at least 0.9 of
/// the running median, or of the largest inlier ratio of all hypotheses if that is less. The test is
/// undecided when x, y or yaw is unobservable, or when no hypothesis has won after eight scans that fit the
/// best one. A hypothesis of expected_at() is not tested for observability.
class HypothesisTest {
 public:
  enum class Outcome { kOpen, kWon, kRefuted, kUndecided };

  /// Corrections of predicted poses: first the hypothesis that a search supports, whose surroundings the map
  /// may cover only in part. `maps`: for each hypothesis an odometer with the map around it; if empty, the
  /// map of the odometer of judge() covers all hypotheses. A single map loaded for all would be unfair: two
  /// hypotheses near each other would be covered by the keyframes of both, and explain more points.
  explicit HypothesisTest(const std::vector<Pose>& map_from_predicted,
                          std::vector<std::unique_ptr<Odometer>> maps = {});
  /// A single hypothesis at which the robot is expected, without a search. `wins`: number of scans that
  /// fitted it already.
  static HypothesisTest expected_at(const Pose& map_from_predicted, int wins);

  /// One more hypothesis, which a search supports, in place of the worst one if there are kMostPlaces; `map`
  /// as in the constructor. Where it fits a scan the counts of all hypotheses begin anew.
  void add(const Pose& map_from_predicted, std::unique_ptr<Odometer> map);

  /// A search excludes all hypotheses but the one near this correction of the predicted pose, which may be
  /// among them.
  void keep_only(const Pose& map_from_predicted, const Pose& predicted);

  /// A search found no contradiction to the hypothesis near this correction, though the map may cover only a
  /// part of its surroundings: its least inlier ratio becomes the lower one.
  void note_uncontradicted(const Pose& map_from_predicted, const LostModeOdometry& lost_odometry);

  /// Whether the hypotheses have maps of their own.
  bool is_elsewhere() const { return hypotheses_.front().map != nullptr; }
  /// Tests one more scan, which lost-mode odometry has followed. The test goes on while the outcome is kOpen,
  /// and may go on after kWon.
  Outcome judge(Odometer& odometer, const PreparedScan& scan, const LostModeOdometry& lost_odometry);
  /// Whether the number of scans within which the test has to decide is used up.
  bool is_spent() const;

  /// Contribution of the scans to the log odds that the best hypothesis is the robot's place rather than that
  /// the map does not cover this hypothesis; within +-kMostOfScans. It follows from the energy of the last
  /// scan less its running median; its upper bound grows with the number of steep surfaces that the scans
  /// meet there, since level ground fits everywhere. 0 if no scan was aligned before.
  double log_odds() const;

  /// The reason for kUndecided, in words.
  const char* why_undecided() const;

  /// The alignment of the last scan at the best hypothesis.
  const Attempt& attempt() const { return hypotheses_.front().attempt; }
  const Pose& map_from_predicted() const { return hypotheses_.front().map_from_predicted; }
  /// All hypotheses that are not refuted, the best first.
  std::vector<Pose> hypotheses() const;

 private:
  struct Hypothesis {
    Pose map_from_predicted;
    std::unique_ptr<Odometer> map;  ///< null: the odometer of judge() is used
    double least_share = 0;         ///< least inlier ratio of a scan that fits, over the running median
    int missed = 0;                 ///< scans that did not fit
    bool fits = false;              ///< whether the last scan fits
    bool tried = false;             ///< whether any scan has fitted
    bool looked_far = false;        ///< whether a scan was aligned with the far reach
    Attempt attempt;                ///< alignment of the last scan
    std::vector<PointMatch> point_matches;  ///< of the last scan
    struct Patch {
      double known = 0, explained = 0, steep = 0;  ///< numbers of points of the scans, see PointMatch
      double off() const { return known - explained; }
    };
    std::vector<Patch> patches;
    double explained() const;                              ///< number of points, over all patches
    bool is_due() const { return !tried && !looked_far; }  ///< as long as true it is not dropped
    /// Standard deviations of the error of the hypothesis.
    double near_metres() const { return tried ? 0.1 : 0.5; }
    double near_radians() const { return (tried ? 2.0 : 3.0) * kDegree; }
  };
  bool fits(const Attempt& attempt, const Hypothesis& hypothesis, double most) const;
  void look_near(Odometer& odometer, const PreparedScan& scan, const LostModeOdometry& lost_odometry,
                 Hypothesis& hypothesis) const;
  void try_hypothesis(Odometer& odometer, const PreparedScan& scan, const LostModeOdometry& lost_odometry,
                      double most, int* far_looks, Hypothesis& hypothesis) const;
  void note_explained(const PreparedScan& scan, const Pose& predicted, bool anew);
  bool is_worse(const Hypothesis& hypothesis, const Hypothesis& other) const;
  void drop_losers(const Pose& predicted);

  std::vector<Hypothesis> hypotheses_;  ///< never empty; the best hypothesis first
  /// Cubes of the predicted frame: index in `patches` and `points_` by Morton key. The points of one cube
  /// share an error.
  std::map<std::uint64_t, std::size_t> patches_;
  std::vector<double> points_;  ///< points in each patch, of the scans since a hypothesis last began to fit
  double patch_ = 0;            ///< metres, edge of the patches
  int wins_ = 0, scans_ = 0;
  bool expected_ = false;
};

}  // namespace scanlock
