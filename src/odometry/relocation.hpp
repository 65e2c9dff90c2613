// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "odometry/contest.hpp"
#include "odometry/excursion.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"
#include "odometry/place_search.hpp"
#include "odometry/sighting.hpp"
#include "odometry/tracked_scan.hpp"

namespace scanlock {

/// Relocalisation, from the first scan that the tracker does not trust: lost-mode odometry (Excursion), local
/// relocalisation near the prediction and the last trusted pose, requests for global searches, and the test
/// of the hypotheses on the scans that follow (Contest). The odometer is the tracker's: its map stays as it
/// is, its state follows the excursion.
class Relocation {
 public:
  enum class Outcome : std::int8_t {
    kLost,
    kFelt,   ///< where it was predicted, last seen, or said to be
    kFound,  ///< in a place that a search proposed
  };

  explicit Relocation(const TrackerConfig& config)
      : config_(config), search_(config.search_cores, PlaceSearch::Parts::kWide) {}

  /// A scan that the map does not explain, and how much of it is left unexplained (0 to 1).
  void distrust(std::int64_t utime, double dt, const PreparedScan& scan, const Odometer& odometer,
                double energy);
  /// Lost at the odometer's state, after it was `last_seen`; nobody knows where, in a map that was loaded.
  /// `looks_alike`: a scan fits there, but it is another place.
  void begin(const Odometer& odometer, const std::optional<Sighting>& last_seen, bool looks_alike,
             const KeyframeArchive& archive);
  /// Scans are explained again, or there is another map: what was seen since is of no use any more.
  void end();

  /// One scan of a lost robot, `dt` seconds after the last. `attempt`: the one that the outcome rests on.
  /// Where none is followed yet the odometer's state is the prediction for this scan.
  Outcome follow(std::int64_t utime, double dt, const PreparedScan& scan, Odometer& odometer,
                 Attempt* attempt);
  /// The same for a scan without points; only while an excursion is followed.
  void coast(double dt, Odometer& odometer);
  /// Which way is up, by an attitude sensor, for the scan that was followed last.
  void note_up(const Eigen::Vector3d& up_in_body) { excursion_->note_up(up_in_body); }

  /// The next search, when there is reason for one and none is out. `up`: in the map frame, where that was
  /// measured.
  std::optional<RecoveryRequest> take_request(std::int64_t utime, const KeyframeArchive& archive,
                                              const std::optional<Eigen::Vector3d>& up);
  /// `voxel` metres: of the map, where another part of it is loaded.
  void give(RecoveryAnswer answer, const KeyframeArchive& archive, double voxel, const Odometer& odometer);
  /// Somebody says that the odometer's state is right: to be tried on the scans that follow.
  void propose_here();

  bool lost() const { return lost_; }
  /// Whether the odometer's map does not show the place that was found.
  bool is_elsewhere() const { return elsewhere_; }
  bool has_excursion() const { return excursion_.has_value(); }
  /// kRecovering, kAmbiguous or kLost.
  TrackingState state() const { return state_; }
  /// Whether the robot sees, and has found no place for so long that it goes on in what it has seen since. In
  /// a map that was loaded only after it has moved: until then it is searched for from where it stands.
  bool gives_up() const;
  /// Only where it has one.
  const Excursion& excursion() const { return *excursion_; }
  Excursion& excursion() { return *excursion_; }
  /// An attempt that came to its end since the last call.
  std::optional<Recovery> take_ended() { return std::exchange(ended_, std::nullopt); }

 private:
  /// Where the robot may be: to be confirmed by the scans that follow.
  struct Candidate {
    Contest contest;
    std::optional<RecoveryAnswer> answer;  ///< of the search; none: felt, or said
    double log_odds = 0;                   ///< of that search, and of those before it
  };
  /// What a search found likeliest.
  struct Find {
    Pose map_from_predicted;
    double log_odds;
    std::size_t keyframes;  ///< that the excursion had by then
    double voxel;           ///< metres: the search's scale
  };
  /// What all searches say for a place.
  struct Support {
    double log_odds = 0;
    int finds = 0;  ///< that name it
  };
  void depart_or_follow(std::int64_t utime, double dt, const PreparedScan& scan, const Odometer& odometer);
  void feel(std::int64_t utime, const PreparedScan& scan, Odometer& odometer, Attempt* attempt);
  Outcome confirm(const PreparedScan& scan, Odometer& odometer, Attempt* attempt);
  void refuse(const std::string& why);
  void follow_excursion(double dt, Odometer& odometer) const;
  std::vector<std::unique_ptr<Odometer>> maps_of(const std::vector<Pose>& places,
                                                 const KeyframeArchive& archive, double voxel,
                                                 const Odometer& odometer) const;
  Support support_of(const Pose& map_from_predicted) const;
  double log_odds_of(const Candidate& candidate) const;
  bool sees_more() const;
  /// Log odds before any search: a map that was loaded need not show the place at all.
  double before() const { return last_seen_ ? kInOwnMap : 0; }
  std::vector<Pose> rivals_of(const RecoveryAnswer& answer) const;
  bool agree(const Pose& a, const Pose& b, double metres, double radians) const;
  Recovery recovery_of(const RecoveryAnswer& answer) const;

  TrackerConfig config_;
  bool lost_ = false;
  TrackingState state_ = TrackingState::kRecovering;
  std::optional<Sighting> last_seen_;
  bool looks_alike_ = false;    ///< what is where it is expected
  bool nothing_found_ = false;  ///< that is likely, by the last search
  int scans_ = 0;               ///< since it was lost
  std::optional<Excursion> excursion_;
  double gate_m_ = 0, gate_rad_ = 0;  ///< how far the prediction may be off where the excursion began
  double energy_before_ = 1;
  std::optional<Candidate> candidate_;
  bool elsewhere_ = false;
  std::vector<Find> finds_;      ///< of this excursion's searches, the newest first
  std::vector<Pose> undecided_;  ///< places that fitted its scans alike
  PlaceSearch search_;
  std::optional<Recovery> ended_;
};

}  // namespace scanlock
