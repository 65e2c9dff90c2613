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

// Bounds on the robust z-score of the energy of an alignment. Correct alignments have less than 5 in streets
// and rooms, alignments after a kidnap 10 and more.
inline constexpr double kFitScore =
    3.0;  ///< above it the scan is aligned again with the far reach: one scan in hundreds
inline constexpr double kJumpScore = 6.0;  ///< above it an alignment is not trusted

/// Largest squared gap (see squared_gap) between an alignment and its prediction, of pose and velocity:
/// drives stay below 3, shaken sensors below 25; kidnaps to a place that looks alike had 35 and 190.
inline constexpr double kMostGap = 30;

/// Welsch scale over sigma: 95 % efficient on Gaussian residuals.
inline constexpr double kKernel = 2.1;

/// Seconds without a trusted scan after which the motion before them predicts the pose poorly.
inline constexpr double kMoment = 0.35;
/// Seconds for which a robot without usable scans is predicted at its last velocity; afterwards, as standing.
inline constexpr double kCoastSeconds = 3.0;

// Points of a scan that suffice to test whether it fits at all (kLookPoints), and to find the velocity
// (kDeskewPoints).
inline constexpr std::size_t kLookPoints = 400, kDeskewPoints = 800;

/// Radius of the search for surfaces in an alignment: for errors of a prediction (kNear), or wider, for a
/// start that may be farther off (kFar).
enum class Reach : std::int8_t { kNear, kFar };

/// The planes that a ray can meet: those that the map saw from the ray's side (kSeen), or all (kBoth). kBoth
/// is for tests of whether a scan fits a place: a plane that cannot be seen from the place then counts as
/// evidence against the place; with kSeen it would count as unknown ground.
enum class Sides : std::int8_t { kSeen, kBoth };

/// One alignment of a scan with the map: pose, prior and quality.
struct Attempt {
  ScanAlignment alignment;
  MotionPrior prior;
  std::optional<MovingPose>
      told;  ///< state by other sensors, for directions that the scene leaves open; else the prior's mean
  Health health;
  double variance = 1;  ///< m^2, of a residual, inflated for the correlation of residuals
  /// Information of the pose, from the data alone, without the part that errors of normals feign; 1/m^2 and
  /// 1/rad^2.
  Matrix6 information() const;
  /// Unexplained share of the scan, 0 to 1.
  double cost() const { return 1.0 - health.overlap * (1.0 - health.energy); }
};

/// A source point. `known`: it met a surface. `explained`: it lies on that surface, by is_inlier() of its
/// residual; on a surface as thick as two neighbouring walls this accepts the points of either wall. `steep`:
/// the surface is not level in the axes of the map; level surfaces look alike everywhere.
struct PointMatch {
  bool known = false, explained = false, steep = false;
};

/// Odometry in a local map, with the recent energies of its alignments. The owner decides which alignment is
/// accepted. Its frame is defined by the pose at which it was started.
class Odometer {
 public:
  explicit Odometer(const TrackerConfig& config);

  /// The scan becomes the map; the velocity of `guess` gets a wide covariance. `utime`: microseconds.
  void start(std::int64_t utime, const PreparedScan& scan, const MovingPose& guess);
  /// Whether the sensor sees only one plane and moves in it. start() determines it from the scan.
  void set_planar(bool planar);
  bool planar() const { return map_.planar(); }
  /// Replaces the map by the archived keyframes around `centre` (map frame); `voxel` in metres. The first
  /// `given` of them are of a given map. The usual energy stays. Throws PointsUnreadable, and changes nothing
  /// then.
  void reload(const std::vector<ArchivedKeyframe>& archived, const Eigen::Vector3d& centre, double voxel,
              std::size_t given = 0);
  /// Founds the map on those of the first `given` archived keyframes that are within max_range_m of the
  /// robot, see LocalMap::found_on(). Returns the distance to the farthest of them; metres. Throws
  /// PointsUnreadable, and changes nothing then.
  double found_on(const std::vector<ArchivedKeyframe>& archived, std::size_t given, double voxel);

  /// Takes over the usual energy of another odometer of the same sensor if no alignment has been accepted
  /// here yet, as in a map that was loaded. No effect otherwise.
  void take_usual_from(const Odometer& other);

  /// Sets the pose, at rest, with a wide covariance of the velocity.
  void set_pose(const Pose& map_from_body);

  MotionPrior predict(double dt) const { return as_lately(filter_.predict(dt)); }
  MotionPrior predict(double dt, const Pose& motion) const { return as_lately(filter_.predict(dt, motion)); }
  Attempt align(const PreparedScan& scan, const MotionPrior& prior, Reach reach, Sides sides = Sides::kSeen);
  /// Aligns with the far reach. A planar scan, and any scan after a gap of more than kMoment, is also aligned
  /// from other headings, unless the first alignment explains it as well as usual.
  Attempt look_far(const PreparedScan& scan, const MotionPrior& prior, Sides sides = Sides::kSeen);
  /// Aligns where success is unlikely: first kLookPoints of the points; where these are far from explained,
  /// their alignment is the result. (An alignment that fails takes longest.)
  Attempt probe(const PreparedScan& scan, const MotionPrior& prior, Reach reach, Sides sides = Sides::kSeen);
  /// The match of each source point of the last alignment. Only while the map is the one that was aligned to.
  std::vector<PointMatch> point_matches();
  /// Edge, metres, of the cubes in which the points of a scan share the errors of their surfaces.
  static double patch(const PreparedScan& scan);
  /// Whether the next scan is the second one, see deskew_first(): an attempt with kDeskewPoints is enough for
  /// that scan.
  bool awaits_second() const { return !first_.points.empty(); }
  /// Ratio of the number of points of a scan, which may be the second one, to that of the first scan.
  double for_one_of_first(const PreparedScan& scan) const {
    return static_cast<double>(scan.fine.size()) / static_cast<double>(first_.points.size());
  }
  /// Removes the distortion by motion from the first scan, once a second scan, `dt` seconds later, shows the
  /// velocity, and aligns the second scan with it. For any other scan returns `attempt` unchanged.
  /// `any_speed`: also tries the speeds of a vehicle; otherwise only velocities near the predicted one, and
  /// zero.
  Attempt deskew_first(const PreparedScan& scan, double dt, Attempt attempt, bool any_speed);

  /// The state becomes the outcome of the alignment, whose energy joins the history.
  void accept(const Attempt& attempt);
  /// The state becomes the prediction, without a measurement.
  void coast(const MotionPrior& prior);
  /// See MotionFilter::stand().
  void stand() { filter_.stand(); }
  /// Adds the scan to the map as a keyframe where it shows new ground or the robot has moved far enough.
  /// `overlap`: the share of its points that the map explains, 0 to 1.
  void keep(std::int64_t utime, const PreparedScan& scan, double overlap);

  bool empty() const { return map_.empty(); }
  const LocalMap& map() const { return map_; }
  const MovingPose& state() const { return filter_.state(); }
  /// Covariance of state() relative to the map around the robot; order and frame as in MotionPrior.
  const Matrix12& covariance() const { return filter_.covariance(); }
  /// Covariance of the pose relative to the map around the robot, estimated from the scans; see MotionErrors.
  Matrix6 pose_covariance() const { return errors_.covariance().topLeftCorner<6, 6>(); }
  /// Covariance of the map around the robot relative to the frame in which the odometer was started; order
  /// and frame as those of the pose in covariance().
  const Matrix6& drift() const { return drift_; }
  void set_drift(const Matrix6& drift) { drift_ = drift; }
  /// The part of drift() that was added since the last call, in the same frame.
  Matrix6 take_new_drift() { return std::exchange(new_drift_, Matrix6::Zero()); }

  /// The usual energy, noise (`sigma`, metres) and inlier ratio of alignments: a value, to be passed to
  /// another odometer of the same sensor.
  struct Usual {
    HealthMonitor health;
    double sigma = 0, share = 1;
  };
  Usual usual() const { return {health_, sigma_, share_}; }
  void set_usual(const Usual& usual);

 private:
  /// The constant velocity that takes the state to `pose` in that time.
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
  /// Factor on the variance of a residual: the points that no plane or line explains also bias the explained
  /// ones.
  double inflation() const;
  double variance() const;  ///< m^2, of a residual as the filter sees it
  double share_ = 1;        ///< inlier ratio of the accepted scans, smoothed

  double sigma_;  ///< metres, standard deviation of a residual: robust, smoothed
  Pose last_keyframe_pose_ = Pose::Identity();
  Keyframe first_;  ///< the first scan, with its points as they came until its motion is known
  Matrix6 drift_ = Matrix6::Zero(), new_drift_ = Matrix6::Zero();
  double untold_ = 0;  ///< share of the map that was seen before any pose was measured
};

/// Whether an alignment explains its scan: enough inliers, an energy below a fixed bound, and a
/// z-score of the energy below `most_score`.
bool explains(const Attempt& attempt, double most_score);

/// The inlier ratio over its running median; 1 without a median.
double inlier_ratio_to_usual(const Health& health);
/// Whether the inlier ratio is at least 0.8 of its running median. A lower one indicates new ground or
/// another place.
bool has_usual_inlier_ratio(const Health& health);

/// The same scan with about `points` points to align.
PreparedScan part_of(const PreparedScan& scan, std::size_t points);

/// The attempt of lower cost().
Attempt better(Attempt a, Attempt b);

}  // namespace scanlock
