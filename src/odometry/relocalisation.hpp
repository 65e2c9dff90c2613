// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "odometry/hypothesis_test.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/lost_mode_odometry.hpp"
#include "odometry/odometer.hpp"
#include "odometry/place_search.hpp"
#include "odometry/tracked_scan.hpp"
#include "odometry/trusted_scan.hpp"

namespace scanlock {

/// Relocalisation, from the first scan that the tracker does not trust: lost-mode odometry, local
/// relocalisation near the prediction and the last trusted pose, requests for global searches, and the test
/// of the hypotheses on the scan at hand and those that follow. The odometer is the tracker's: its map stays
/// as it is, its state follows lost-mode odometry.
class Relocalisation {
 public:
  enum class Outcome : std::int8_t {
    kLost,
    kLocally,  ///< local relocalisation: at the prediction, the last trusted pose, or a pose that was given
    kFound,    ///< relocalised at a hypothesis of a global search
  };

  explicit Relocalisation(const TrackerConfig& config)
      : config_(config), search_(config.search_cores, PlaceSearch::Parts::kWide) {}

  /// Takes a scan that the map does not explain; `energy`: of its alignment (0 to 1).
  void distrust(std::int64_t utime, double dt, const PreparedScan& scan, const Odometer& odometer,
                double energy);
  /// The robot is lost at the odometer's state. `last_seen`: the last trusted scan; nullopt in a map that was
  /// loaded, where the pose is not known. `looks_alike`: a scan fits there, but the robot may be at another
  /// place that looks like the expected one.
  void begin(const Odometer& odometer, const std::optional<TrustedScan>& last_trusted, bool looks_alike,
             const KeyframeArchive& archive);
  /// Scans are explained again, or the map is another: discards what was seen since the robot was lost.
  void end();

  /// Processes one scan of a lost robot, `dt` seconds after the last. `attempt`: receives the alignment that
  /// the outcome rests on. Where lost-mode odometry has not begun, the odometer's state has to be the
  /// prediction for this scan.
  Outcome follow(std::int64_t utime, double dt, const PreparedScan& scan, Odometer& odometer,
                 Attempt* attempt);
  /// The same for a scan without points; only where has_lost_odometry().
  void coast(double dt, Odometer& odometer);
  /// The upward direction by an attitude sensor, for the scan that was followed last; body axes, unit.
  void note_up(const Eigen::Vector3d& up_in_body) { lost_odometry_->note_up(up_in_body); }

  /// The next search, when one is due and none is unanswered. `up`: upward direction in the map frame, where
  /// it was measured.
  std::optional<RecoveryRequest> take_request(std::int64_t utime, const KeyframeArchive& archive,
                                              const std::optional<Eigen::Vector3d>& up);
  /// Takes the answer to a request. `voxel`: metres, of the maps that are loaded around hypotheses.
  void give(RecoveryAnswer answer, const KeyframeArchive& archive, double voxel, Odometer& odometer);
  /// The odometer's state becomes a hypothesis, as a user gave it, to be tested on the scans that follow.
  void propose_here();

  bool lost() const { return lost_; }
  /// Whether the accepted hypothesis is at a place that the odometer's map does not show.
  bool is_elsewhere() const { return elsewhere_; }
  bool has_lost_odometry() const { return lost_odometry_.has_value(); }
  /// kRecovering, kAmbiguous or kLost.
  TrackingState state() const { return state_; }
  /// Whether scans have fitted each other for new_map_after_s without a hypothesis under test, so that the
  /// robot goes on in the map of lost-mode odometry. In a map that was loaded only after it has moved: until
  /// then it is searched for from where it stands.
  bool gives_up() const;
  /// Only where has_lost_odometry().
  const LostModeOdometry& lost_odometry() const { return *lost_odometry_; }
  LostModeOdometry& lost_odometry() { return *lost_odometry_; }
  /// The attempt at relocalisation that ended since the last call, if any.
  std::optional<Recovery> take_ended() { return std::exchange(ended_, std::nullopt); }

 private:
  /// Hypotheses that are being tested on the scans that follow.
  struct RunningTest {
    HypothesisTest test;
    /// Of the searches that found hypotheses; none for local relocalisation and a given pose.
    std::vector<RecoveryAnswer> answers;
    double log_odds = 0;  ///< by the first of these searches and those before it
  };
  /// The likeliest hypothesis of a search.
  struct SearchResult {
    Pose map_from_predicted;
    double log_odds;
    std::size_t keyframes;  ///< that lost-mode odometry had by then
    double voxel;           ///< metres: the search's scale
  };
  /// The evidence of all searches for a place.
  struct Support {
    double log_odds = 0;
    int finds = 0;  ///< number of search results that name it
  };
  void depart_or_follow(std::int64_t utime, double dt, const PreparedScan& scan, const Odometer& odometer);
  void relocalise_locally(std::int64_t utime, const PreparedScan& scan, Odometer& odometer, Attempt* attempt);
  Outcome confirm(const PreparedScan& scan, Odometer& odometer, Attempt* attempt);
  void refuse(const std::string& why);
  void follow_lost_odometry(double dt, Odometer& odometer) const;
  const RecoveryAnswer& answer_for(const RunningTest& test) const;
  void join_test(RecoveryAnswer answer, const KeyframeArchive& archive, double voxel,
                 const Odometer& odometer);
  std::vector<std::unique_ptr<Odometer>> maps_of(const std::vector<Pose>& places,
                                                 const KeyframeArchive& archive, double voxel,
                                                 const Odometer& odometer) const;
  Support support_of(const Pose& map_from_predicted) const;
  double log_odds_of(const RunningTest& candidate) const;
  bool sees_more() const;
  /// Log odds before any search: kInOwnMap, or 0 in a map that was loaded, which need not show the place.
  double before() const { return last_trusted_ ? kInOwnMap : 0; }
  std::vector<Pose> runners_up_of(const RecoveryAnswer& answer) const;
  bool agree(const Pose& a, const Pose& b, double times) const;
  Recovery recovery_of(const RecoveryAnswer& answer, const std::string& why = {}) const;

  TrackerConfig config_;
  bool lost_ = false;
  TrackingState state_ = TrackingState::kRecovering;
  std::optional<TrustedScan> last_trusted_;
  bool looks_alike_ = false;    ///< the robot may be at another place that looks like the expected one
  bool nothing_found_ = false;  ///< the last search found no likely place
  int scans_ = 0;               ///< since the robot was lost
  std::optional<LostModeOdometry> lost_odometry_;
  std::optional<PreparedScan> last_scan_;  ///< that lost-mode odometry followed last; none where it coasted
  double gate_m_ = 0, gate_rad_ = 0;  ///< how far the prediction may be off where lost-mode odometry began
  double energy_before_ = 1;
  std::optional<RunningTest> running_test_;
  bool elsewhere_ = false;
  std::vector<SearchResult>
      search_results_;           ///< of the searches since lost-mode odometry began, the newest first
  std::vector<Pose> undecided_;  ///< hypotheses that its scans fitted equally well
  PlaceSearch search_;
  std::optional<Recovery> ended_;
};

}  // namespace scanlock
