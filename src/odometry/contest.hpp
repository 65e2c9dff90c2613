// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "geometry/rigid.hpp"
#include "odometry/excursion.hpp"
#include "odometry/odometer.hpp"
#include "odometry/recovery.hpp"

namespace scanlock {

/// Places where a lost robot may be, tried on the scans that follow. One is believed when it explains a few
/// of them in a row, and clearly better than any other does: two that do equally well are told apart by
/// neither, and one that could as well stand a little farther on is none.
class Contest {
 public:
  enum class Outcome { kOpen, kWon, kRefuted, kUndecided };

  /// Corrections of predicted poses, the favourite first, and what speaks for it.
  Contest(const std::vector<Pose>& map_from_predicted, PlaceEvidence evidence);
  /// One that needs no search, for the robot is expected there. `wins`: scans that it has explained already.
  Contest(const Pose& map_from_predicted, int wins);

  /// Of a rival (a correction, about): nothing contradicts it, though the map may not know all that is seen
  /// there.
  void note_standing(const Pose& map_from_predicted, const Excursion& excursion);

  /// One more scan, which the excursion has followed. Only kOpen goes on.
  Outcome judge(Odometer& odometer, const PreparedScan& scan, const Excursion& excursion);

  /// What left it undecided, for people.
  const char* why_undecided() const;

  /// Of the place that leads, on the last scan.
  const Attempt& attempt() const { return places_.front().attempt; }
  const Pose& map_from_predicted() const { return places_.front().map_from_predicted; }
  /// All that are still in question.
  std::vector<Pose> places() const;

 private:
  struct Place {
    Pose map_from_predicted;
    double least_share = 0, winners_share = 0;  ///< of the usual share of inliers, to fit, and to win
    int missed = 0;
    bool sound = false;       ///< nearly all that was seen is there, and nothing contradicts (PlaceEvidence)
    bool standing = false;    ///< see note_standing()
    bool fits = false;        ///< the last scan
    bool could_win = false;   ///< by it
    bool tried = false;       ///< it has fitted
    bool looked_far = false;  ///< or was looked for farther off
    Attempt attempt;
    std::vector<float> explained_points;  ///< of the last scan, see Odometer::explained()
    struct Patch {
      double explained = 0, known = 0;  ///< points of the scans; the latter met any surface
    };
    std::vector<Patch> patches;
    double explained() const;                              ///< points of all patches
    bool is_due() const { return !tried && !looked_far; }  ///< before that it cannot be out
  };
  void try_place(Odometer& odometer, const PreparedScan& scan, const Excursion& excursion, int* far_looks,
                 Place& place) const;
  void note_explained(const PreparedScan& scan, const Pose& predicted, bool anew);
  bool is_worse(const Place& place, const Place& leader) const;
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
