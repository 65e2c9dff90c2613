// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "icp/scan_alignment.hpp"
#include "odometry/health.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/local_map.hpp"
#include "odometry/motion_errors.hpp"
#include "odometry/motion_filter.hpp"
#include "odometry/scan_preparation.hpp"
#include "odometry/tracker_config.hpp"

namespace scanlock {

// Trust in an alignment, by the robust z-score of its energy. That of good ones stays below 5 in streets and
// rooms; a kidnap gives 10 and more.
inline constexpr double kFitScore =
    3.0;  ///< beyond, another look is worth its time: it is one scan in hundreds
inline constexpr double kJumpScore = 6.0;
inline constexpr double kCalmScore = 4.0;  ///< hysteresis: what a lost robot must get below

/// How far pose and velocity are from their prediction, squared: drives stay below 3, shakes below 25;
/// kidnaps to a place that looks alike had 35 and 190.
inline constexpr double kMostGap = 30;

/// Welsch scale over sigma: 95 % efficient on Gaussian residuals.
inline constexpr double kKernel = 2.1;

/// Seconds without a scan in which a robot may do anything.
inline constexpr double kMoment = 0.35;
/// A robot that sees nothing is predicted at its last velocity for so long, then as standing.
inline constexpr double kCoastSeconds = 3.0;

// Points of a scan that tell whether it fits at all, and how the robot moved.
inline constexpr std::size_t kLookPoints = 400, kDeskewPoints = 800;

/// How far an alignment looks for its surfaces: as far as the prediction may be off, or farther where it is
/// not believed.
enum class Reach : std::int8_t { kNear, kFar };

/// One alignment of a scan with the map, and what it is worth.
struct Attempt {
  ScanAlignment alignment;
  MotionPrior prior;
  std::optional<MovingPose>
      told;  ///< by other sensors, for what the scene leaves open; else the prior's mean
  Health health;
  double variance = 1;  ///< m^2, of a residual, its correlations counted in
  /// Of its pose alone: of the data, less what errors of normals make of it, m^-2 and so on.
  Matrix6 information() const;
  /// Unexplained share of the scan.
  double cost() const { return 1.0 - health.overlap * (1.0 - health.energy); }
};

/// A local map, the motion within it, and what alignments with it usually cost: odometry without judgement.
/// Who owns it decides what is believed. Its frame is where it was started.
class Odometer {
 public:
  explicit Odometer(const TrackerConfig& config);

  /// The scan becomes the map; the velocity is a guess, and may be anything.
  void start(std::int64_t utime, const PreparedScan& scan, const MovingPose& guess);
  /// Whether its sensor sees one plane only and moves in it. A start asks its scan.
  void set_planar(bool planar);
  bool planar() const { return map_.planar(); }
  /// The map becomes what was archived around the `centres` (map frame): around each as much as it would be
  /// around that alone. What is usual stays. Throws PointsUnreadable, and changes nothing then.
  void reload(const std::vector<ArchivedKeyframe>& archived, const std::vector<Eigen::Vector3d>& centres,
              double voxel);

  /// What alignments cost where nothing was aligned yet, a map that was loaded: as they cost another odometer
  /// of the same sensor. Without effect once it knows for itself.
  void take_usual_from(const Odometer& other);

  /// Forgets what alignments cost here: the next one that is accepted says it anew.
  void forget_usual() { health_.forget(); }

  /// At rest there, the velocity unknown.
  void set_pose(const Pose& map_from_body);

  MotionPrior predict(double dt) const { return as_lately(filter_.predict(dt)); }
  MotionPrior predict(double dt, const Pose& motion) const { return as_lately(filter_.predict(dt, motion)); }
  Attempt align(const PreparedScan& scan, const MotionPrior& prior, Reach reach);
  /// The same with the far reach; of a planar scan, and after a gap, from other headings as well, where that
  /// does not explain it as well as usual.
  Attempt look_far(const PreparedScan& scan, const MotionPrior& prior);
  /// The same where success is unlikely: a part of the points is tried first, and when that does not come
  /// near to explaining itself, it is what comes back. An alignment that fails takes the longest of all.
  Attempt probe(const PreparedScan& scan, const MotionPrior& prior, Reach reach);
  /// Of each source point of the last alignment, how far the map explains it: 1 on a surface, 0 off all.
  std::vector<float> explained() const;
  /// Edge, metres, of the cubes of a scene in which points share the errors of their surfaces.
  static double patch(const PreparedScan& scan);
  /// Whether the next scan is that second one, for which an attempt with kDeskewPoints will do.
  bool awaits_second() const { return !first_.points.empty(); }
  /// Of a scan that may be that one: how many points it has for one of the first.
  double for_one_of_first(const PreparedScan& scan) const {
    return static_cast<double>(scan.fine.size()) / static_cast<double>(first_.points.size());
  }
  /// Aligns with the first scan, after that one's own motion was taken out: possible only once a second one
  /// shows the velocity, `dt` seconds later. Other attempts come back as they are. `any_speed`: of a vehicle;
  /// else near the one predicted, or none.
  Attempt deskew_first(const PreparedScan& scan, double dt, Attempt attempt, bool any_speed);

  /// The state becomes the outcome, and its energy part of what is usual.
  void accept(const Attempt& attempt);
  /// The state becomes the prediction: nothing was learnt.
  void coast(const MotionPrior& prior);
  /// Nothing was seen for long: it is predicted as standing from now on.
  void stand() { filter_.stand(); }
  /// The scan joins the map where it shows new ground.
  void keep(std::int64_t utime, const PreparedScan& scan, double overlap);

  bool empty() const { return map_.empty(); }
  const LocalMap& map() const { return map_; }
  const MovingPose& state() const { return filter_.state(); }
  /// Of state() against the map around the robot, as the next prediction needs it.
  const Matrix12& covariance() const { return filter_.covariance(); }
  /// Of the pose alone, with what the motion within the scan adds.
  Matrix6 pose_covariance() const;
  /// Of the map around the robot, against the frame in which it was started: order and frame as those of the
  /// pose in covariance().
  const Matrix6& drift() const { return drift_; }
  void set_drift(const Matrix6& drift) { drift_ = drift; }
  /// What was added to it since the last call, in the same frame.
  Matrix6 take_new_drift() { return std::exchange(new_drift_, Matrix6::Zero()); }

  /// What alignments usually cost: a value, for another odometer of the same sensor.
  struct Usual {
    HealthMonitor health;
    double sigma = 0, share = 1;
  };
  Usual usual() const { return {health_, sigma_, share_}; }
  void set_usual(const Usual& usual);

 private:
  /// What leads from the state to there.
  Vector6 twist_to(const Pose& pose, double seconds) const;
  ScanAlignmentOptions options(const PreparedScan& scan, const MotionPrior& prior, Reach reach) const;
  void insert(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving);
  bool wants_keyframe(double overlap, double voxel) const;
  void follow_drift(const Pose& before);
  MotionPrior as_lately(MotionPrior prior) const;
  void add_drift(const Matrix6& more);

  TrackerConfig config_;
  LocalMap map_;
  MotionFilter filter_;
  MotionErrors errors_;
  ScanAligner aligner_;
  HealthMonitor health_;
  /// Of a residual's variance: what is left unexplained by planes and lines bends what is explained.
  double inflation() const;
  double variance() const;  ///< m^2, of a residual as the filter sees it
  double share_ = 1;        ///< of a scan that is explained, smoothed

  double sigma_;  ///< metres, of a residual: robust, smoothed
  Pose last_keyframe_pose_ = Pose::Identity();
  Keyframe first_;  ///< its points as they came, until their motion is known
  Matrix6 drift_ = Matrix6::Zero(), new_drift_ = Matrix6::Zero();
  Vector6 bend_ = Vector6::Zero();  ///< see unsolved_bend()
  /// Of the last pose against the map, as far as a scan told it: what new ground is seen with.
  Matrix6 measured_ = Matrix6::Zero();
  double untold_ = 0;  ///< share of the map that was seen before any pose was measured
};

/// The score of a part of a scan beyond which the scan as a whole does not come below kJumpScore.
inline constexpr double kHopelessScore = 2.0 * kJumpScore;

/// Whether an alignment explains its scan: enough overlap, and an energy at most `most_score` above what is
/// usual.
bool explains(const Attempt& attempt, double most_score);

/// Whether the share of inliers is about the usual one: less is new ground, or another place.
bool usual_share(const Health& health);

/// The same scan with about so many points to align.
PreparedScan part_of(const PreparedScan& scan, std::size_t points);

/// The one that leaves less unexplained.
Attempt better(Attempt a, Attempt b);

}  // namespace scanlock
