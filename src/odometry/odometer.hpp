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

// Bounds on the robust z-score of the energy of an alignment. Right alignments have less than 5 in streets
// and rooms, kidnaps 10 and more.
inline constexpr double kFitScore =
    3.0;  ///< beyond, the scan is aligned again with the far reach: one scan in hundreds
inline constexpr double kJumpScore = 6.0;  ///< beyond, an alignment is not trusted

/// Largest squared gap (see squared_gap) of pose and velocity from their prediction: drives stay below 3,
/// shakes below 25; kidnaps to a place that looks alike had 35 and 190.
inline constexpr double kMostGap = 30;

/// Welsch scale over sigma: 95 % efficient on Gaussian residuals.
inline constexpr double kKernel = 2.1;

/// Seconds without a trusted scan, after which the motion before them says little of the pose.
inline constexpr double kMoment = 0.35;
/// A robot that sees nothing is predicted at its last velocity for so long, then as standing.
inline constexpr double kCoastSeconds = 3.0;

// Points of a scan that are enough to test whether it fits at all, and to find the velocity.
inline constexpr std::size_t kLookPoints = 400, kDeskewPoints = 800;

/// Radius of the search for surfaces in an alignment: that of the prediction's error, or a wider one for a
/// start that may be farther off.
enum class Reach : std::int8_t { kNear, kFar };

/// The planes that a ray meets: those that were seen from its side, or all. Where it is asked whether a scan
/// fits a place, all: what is out of sight from there is no unknown ground, and speaks against the place.
enum class Sides : std::int8_t { kSeen, kBoth };

/// One alignment of a scan with the map: pose, prior and quality.
struct Attempt {
  ScanAlignment alignment;
  MotionPrior prior;
  std::optional<MovingPose>
      told;  ///< by other sensors, along directions that the scene leaves open; else the prior's mean
  Health health;
  double variance = 1;  ///< m^2, of a residual, inflated by the correlation of residuals
  /// Of the pose, from the data alone, less the part that errors of normals feign; 1/m^2 and 1/rad^2.
  Matrix6 information() const;
  /// Unexplained share of the scan.
  double cost() const { return 1.0 - health.overlap * (1.0 - health.energy); }
};

/// A source point: whether it met a surface, lies on it (is_inlier() of its residual, so that one as thick as
/// two walls that are near each other takes in what lies on either), and met one that stands up (is not level
/// in the axes of the map), for level ones look alike everywhere.
struct PointMatch {
  bool known = false, explained = false, steep = false;
};

/// Odometry in a local map, with the usual energy of its alignments. It does not decide which alignment is
/// accepted: its owner does. Its frame is the pose at which it was started.
class Odometer {
 public:
  explicit Odometer(const TrackerConfig& config);

  /// The scan becomes the map; the velocity of `guess` has a wide covariance.
  void start(std::int64_t utime, const PreparedScan& scan, const MovingPose& guess);
  /// Whether its sensor sees one plane only and moves in it. start() takes it from the scan.
  void set_planar(bool planar);
  bool planar() const { return map_.planar(); }
  /// The map becomes the archived keyframes around `centre` (map frame). The first `given` of them are of a
  /// given map. The usual energy stays. Throws PointsUnreadable, and changes nothing then.
  void reload(const std::vector<ArchivedKeyframe>& archived, const Eigen::Vector3d& centre, double voxel,
              std::size_t given = 0);
  /// The map is founded on those of the first `given` archived keyframes that are within range of the robot,
  /// see LocalMap::found_on(). Returns metres to the farthest of them. Throws PointsUnreadable, and changes
  /// nothing then.
  double found_on(const std::vector<ArchivedKeyframe>& archived, std::size_t given, double voxel);

  /// Takes over the usual energy of another odometer of the same sensor, until something was aligned here, as
  /// in a map that was loaded. Without effect afterwards.
  void take_usual_from(const Odometer& other);

  /// At rest there, the velocity unknown.
  void set_pose(const Pose& map_from_body);

  MotionPrior predict(double dt) const { return as_lately(filter_.predict(dt)); }
  MotionPrior predict(double dt, const Pose& motion) const { return as_lately(filter_.predict(dt, motion)); }
  Attempt align(const PreparedScan& scan, const MotionPrior& prior, Reach reach, Sides sides = Sides::kSeen);
  /// Aligns with the far reach; a planar scan, and any scan after a gap, also from other headings, unless the
  /// first alignment explains it as well as usual.
  Attempt look_far(const PreparedScan& scan, const MotionPrior& prior, Sides sides = Sides::kSeen);
  /// Aligns where success is unlikely: with part of the points first, and where these are far from explained,
  /// that is the result. (An alignment that fails takes longest.)
  Attempt probe(const PreparedScan& scan, const MotionPrior& prior, Reach reach, Sides sides = Sides::kSeen);
  /// Of each source point of the last alignment, as long as the map is the one that it was aligned to.
  std::vector<PointMatch> point_matches();
  /// Edge, metres, of the cubes of a scene in which points share the errors of their surfaces.
  static double patch(const PreparedScan& scan);
  /// Whether the next scan is the second one, see deskew_first(): an attempt with kDeskewPoints is enough for
  /// it.
  bool awaits_second() const { return !first_.points.empty(); }
  /// Ratio of the points of a scan, which may be the second one, to those of the first.
  double for_one_of_first(const PreparedScan& scan) const {
    return static_cast<double>(scan.fine.size()) / static_cast<double>(first_.points.size());
  }
  /// Takes the motion out of the first scan, once a second one, `dt` seconds later, shows the velocity, and
  /// aligns the second with it. Attempts of any other scan come back as they are. `any_speed`: the speeds of
  /// a vehicle are tried; else those near the predicted one, and zero.
  Attempt deskew_first(const PreparedScan& scan, double dt, Attempt attempt, bool any_speed);

  /// The state becomes the outcome, and its energy part of the history.
  void accept(const Attempt& attempt);
  /// The state becomes the prediction, without a measurement.
  void coast(const MotionPrior& prior);
  /// See MotionFilter::stand().
  void stand() { filter_.stand(); }
  /// The scan joins the map where it shows new ground.
  void keep(std::int64_t utime, const PreparedScan& scan, double overlap);

  bool empty() const { return map_.empty(); }
  const LocalMap& map() const { return map_; }
  const MovingPose& state() const { return filter_.state(); }
  /// Of state() against the map around the robot; order and frame as in MotionPrior.
  const Matrix12& covariance() const { return filter_.covariance(); }
  /// Of the pose against the same, without taking anything for granted; see MotionErrors.
  Matrix6 pose_covariance() const { return errors_.covariance().topLeftCorner<6, 6>(); }
  /// Of the map around the robot, against the frame in which it was started: order and frame as those of the
  /// pose in covariance().
  const Matrix6& drift() const { return drift_; }
  void set_drift(const Matrix6& drift) { drift_ = drift; }
  /// The part of drift() that was added since the last call, in the same frame.
  Matrix6 take_new_drift() { return std::exchange(new_drift_, Matrix6::Zero()); }

  /// The usual energy, noise and share of inliers of alignments: a value, for another odometer of the same
  /// sensor.
  struct Usual {
    HealthMonitor health;
    double sigma = 0, share = 1;
  };
  Usual usual() const { return {health_, sigma_, share_}; }
  void set_usual(const Usual& usual);

 private:
  /// What leads from the state to there.
  Vector6 twist_to(const Pose& pose, double seconds) const;
  ScanAlignmentOptions options(const PreparedScan& scan, const MotionPrior& prior, Reach reach,
                               Sides sides) const;
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
  double untold_ = 0;  ///< share of the map that was seen before any pose was measured
};

/// Whether an alignment explains its scan: enough inliers and overlap, and a z-score of the energy below
/// `most_score`.
bool explains(const Attempt& attempt, double most_score);

/// Whether the share of inliers is at least 0.8 of its running median: less is new ground, or another place.
bool usual_share(const Health& health);

/// The same scan with about `points` points to align.
PreparedScan part_of(const PreparedScan& scan, std::size_t points);

/// The attempt of lower cost().
Attempt better(Attempt a, Attempt b);

}  // namespace scanlock
