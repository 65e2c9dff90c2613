// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// A part of a map in which a pose is searched for.
struct SearchTarget {
  std::vector<ArchivedKeyframe> places;              ///< keyframes of the whole map
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the part, map frame, metres
  double source_radius = 0;                          ///< metres, of the source cloud
  double radius = 0;                                 ///< metres, of the part about the centre
  double voxel = 0;                                  ///< metres
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();     ///< in the map frame
};

/// A global search: the recent scans as one cloud (the source), and the part of the map in which their pose
/// is searched for. A value: another thread can work on it while the tracker goes on.
struct RecoveryRequest {
  std::int64_t serial = 0;
  std::int64_t utime = 0;  ///< microseconds, stamp of the newest scan in `source`
  /// The points seen since the robot got lost; axes of the predicted map frame, relative to `source_centre`.
  PointCloud source;
  Eigen::Vector3d source_centre = Eigen::Vector3d::Zero();
  SearchTarget target;  ///< searched with a wider voxel where the source is sparse
  bool planar = false;  ///< the source is of a planar sensor
  bool finer = false;   ///< a finer voxel may be used, if only that shows enough points of steep surfaces
  double tilt = 0;      ///< radians: error of the attitudes that the search allows for
  /// The z axis of the body, axes of the predicted map frame, unit.
  Eigen::Vector3d body_up = Eigen::Vector3d::UnitZ();
  /// The directions that body_up may have at the robot's place, axes of the map, unit; empty where up is
  /// measured.
  std::vector<Eigen::Vector3d> body_ups;
  /// The upward direction by an attitude sensor, axes of the predicted map frame: valid also on slopes on
  /// which the robot never stood.
  std::optional<Eigen::Vector3d> source_up;
  /// Hypotheses (map_from_predicted) between which earlier scans could not decide.
  std::vector<Pose> undecided;
};

enum class PlaceVerdict : std::int8_t {
  kFound,    ///< hypotheses to be tested on the scans that follow
  kNotHere,  ///< no pose there has a consensus that is large enough and proven to be the largest
};

/// Metres and radians: poses within both of each other are the same place.
inline constexpr double kSamePlace = 0.5, kSameHeading = 3.0 * kDegree;
/// Whether two corrections map a predicted pose to the same place, within `times` these bounds. (The distance
/// of their own translations is no measure: it grows with the distance from the map's origin.)
bool same_place(const Pose& a, const Pose& b, const Pose& predicted, double times = 1);
/// `times`, of results of two searches that agree, and of a hypothesis from scan to scan.
inline constexpr double kAgree = 2;
/// The axes along which places differ, as bits (see Degeneracy): x, y and yaw.
inline constexpr std::uint32_t kOnTheGround = 0b100011;

/// Share of the source that the map shows at a pose, below which it shows little of it.
inline constexpr double kLittleOverlap = 0.5;
/// Number of earlier search results that have to agree before two submaps are joined.
inline constexpr std::size_t kAgreeing = 1;
/// Largest contradiction (see CloudFit) of a search result by which submaps may be joined.
inline constexpr double kSoundContradiction = 0.015;
/// Log odds that a hypothesis is right, from all searches that name it (see CloudRegistration) and from the
/// scans that follow (see HypothesisTest::log_odds()), from which on it is accepted. With all search results
/// put to the test, none of 990 scans in maps of other buildings had more than 0.2, and 98 % of 1052 at the
/// right place had 5 and more.
inline constexpr double kBelieved = 5.0;
/// Bound on the log odds that the scans add, positive or negative.
inline constexpr double kMostOfScans = 10.0;
/// Log odds before any search that a robot lost in the map it built itself is somewhere in it: 20 to 1.
inline constexpr double kInOwnMap = 3.0;
/// The combined log odds of searches that name the same place. Searches share much of their data, so that any
/// two are correlated by 1/2: n equal results are worth 2 n / (n + 1) of one. So the k-th, in descending
/// order, adds 2 / (k (k + 1)) of its log odds where these are positive. Negative log odds count half; where
/// all are negative, the number nearest to zero counts whole.
double together(std::vector<double> log_odds);
/// Hypotheses that are tested at once, and search results that are remembered: caps on their cost.
inline constexpr std::size_t kMostPlaces = 5, kMostResults = 20;

/// Radius of the part of a map that is searched at once, over the radius of the source: in a building the
/// part is the whole map, so that all places that look alike are hypotheses of one search.
inline constexpr double kWidestPart = 6;

/// The result of a search.
struct RecoveryAnswer {
  std::int64_t serial = 0;
  std::int64_t utime = 0;
  PlaceVerdict verdict = PlaceVerdict::kNotHere;
  Pose map_from_predicted = Pose::Identity();  ///< corrects predicted poses; of the likeliest hypothesis
  std::vector<Pose> runners_up;                ///< the same, of the other hypotheses
  /// Those of the request's `undecided` that the map does not contradict, though it lacks much of the source
  /// there.
  std::vector<Pose> uncontradicted;
  /// Of the largest consensus, which need not be that of the likeliest hypothesis. See also PlanarPart.
  int matches = 0, matches_kept = 0, consensus = 0, upper_bound = 0, runner_up_consensus = 0;
  bool certified = false;
  double voxel = 0;          ///< metres, as requested
  double contradiction = 0;  ///< see CloudFit; of the likeliest hypothesis
  double missing = 0;        ///< see CloudFit; of the likeliest hypothesis
  double log_odds = 0;       ///< see CloudRegistration; of the likeliest hypothesis
  bool little = false;       ///< less than half of the source is in the map there
  bool no_rival = false;     ///< proven: at any other place the log odds are lower by kBelieved or more
  std::string reason;
  std::string map_fault;  ///< see TrackedScan; if not empty, nothing was found
  std::int64_t nodes = 0;
  double search_ms = 0, total_ms = 0;  ///< of CPU
  /// Estimated seconds of CPU, from the numbers of points described and matches examined: the same on every
  /// machine.
  double cost_s = 0;
};

/// Searches for a place by certified 4DOF registration. Deterministic: the budget counts nodes, not seconds.
/// Remembers the last few targets, which are requested repeatedly.
class PlaceFinder {
 public:
  PlaceFinder();
  ~PlaceFinder();
  PlaceFinder(PlaceFinder&&) noexcept;
  PlaceFinder& operator=(PlaceFinder&&) noexcept;
  RecoveryAnswer find(const RecoveryRequest& request);
  /// Describes a target ahead of the searches in it; of use to those whose source is dense enough for its
  /// voxel.
  void prepare(const SearchTarget& target);

  static constexpr std::size_t kTargets = 6;  ///< that are remembered, of some megabytes each

 private:
  struct Target;
  /// The remembered target, or a new one, whose cost is then added to `cost_s`.
  Target& known(const SearchTarget& wanted, bool planar, double* cost_s);
  std::vector<std::unique_ptr<Target>> targets_;  ///< the most recently used comes last
};

}  // namespace scanlock
