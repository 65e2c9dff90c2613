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
  std::vector<ArchivedKeyframe> places;              ///< of the whole map
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the part, map frame
  double source_radius = 0;                          ///< metres: of the source cloud
  double radius = 0;                                 ///< metres about the centre
  double voxel = 0;                                  ///< metres
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();     ///< in the map frame
};

/// A global search: the recent scans as one cloud, and the part of the map in which to find their pose. A
/// value: it can be worked on by another thread while the tracker goes on.
struct RecoveryRequest {
  std::int64_t serial = 0;
  std::int64_t utime = 0;  ///< microseconds, stamp of the newest scan in `source`
  /// What was seen since the robot got lost, axes of the predicted map frame, relative to `source_centre`.
  PointCloud source;
  Eigen::Vector3d source_centre = Eigen::Vector3d::Zero();
  SearchTarget target;  ///< its voxel is wider where the source is sparse
  bool finer = false;   ///< or finer, where it shows hardly anything that stands, and a finer one does
  double tilt = 0;      ///< radians: how well attitudes are known
  /// The z axis of the body, axes of the predicted map frame.
  Eigen::Vector3d body_up = Eigen::Vector3d::UnitZ();
  /// What it may be at its place, axes of the map, unit; empty where up is measured.
  std::vector<Eigen::Vector3d> stands;
  /// Up as an attitude sensor measured it, axes of the predicted map frame: goes for slopes on which the
  /// robot never stood, too.
  std::optional<Eigen::Vector3d> source_up;
  /// Corrections of predicted poses between which scans could not decide.
  std::vector<Pose> undecided;
};

enum class PlaceVerdict : std::int8_t {
  kFound,    ///< places to be tried on the scans that follow
  kNotHere,  ///< no place there has enough of a consensus, or that it has is not proven
};

/// Metres and radians: poses so near each other are the same place.
inline constexpr double kSamePlace = 0.5, kSameHeading = 3.0 * kDegree;
/// The axes that tell places apart, as bits (see Degeneracy): x, y and yaw.
inline constexpr std::uint32_t kOnTheGround = 0b100011;

/// Earlier finds that have to say the same before two submaps are joined; with a planar sensor, whose rooms
/// are soon like one another, also before a place is believed.
inline constexpr std::ptrdiff_t kAgreeing = 1, kPlanarAgreeing = 3;
/// Of what was seen, the share that contradicts a place (see CloudFit) which is sound nevertheless.
inline constexpr double kSoundContradiction = 0.015;
/// Log odds that a place is the robot's, by all searches that name it (see CloudRegistration) and by the
/// scans that follow (see Contest::log_odds()), from which it is believed. With all finds put to the test,
/// none of 990 scans in maps of other buildings had more than 0.2, and 98 % of 1052 at the right place had 5
/// and more.
inline constexpr double kBelieved = 5.0;
/// The most of these, and the least, that the scans add.
inline constexpr double kMostOfScans = 10.0;
/// Log odds before any search that a robot lost in a map of its own is somewhere in it: 20 to 1.
inline constexpr double kInOwnMap = 3.0;
/// What searches that name the same place say together. They see much of the same, so that any two are
/// correlated by 1/2: n that say the same are worth 2 n / (n + 1) of one. So the k-th, the surest first, adds
/// 2 / (k (k + 1)) of what it says for the place. What speaks against it counts half; where all do, the one
/// that says least counts whole.
double together(std::vector<double> log_odds);
/// Places that are tried at once, and finds that are remembered: caps on their cost.
inline constexpr std::size_t kMostPlaces = 5, kMostFinds = 20;

/// Radius of the part of a map that is searched at once, in times the source's: in a building it is the whole
/// map, so that all places that look alike are rivals in one search.
inline constexpr double kWidestPart = 6;

/// What a search found.
struct RecoveryAnswer {
  std::int64_t serial = 0;
  std::int64_t utime = 0;
  PlaceVerdict verdict = PlaceVerdict::kNotHere;
  Pose map_from_predicted = Pose::Identity();  ///< corrects predicted poses; of the likeliest place
  std::vector<Pose> rivals;                    ///< the same, of other places that come into question
  /// Of the undecided ones, those that nothing contradicts, though much of what was seen is not there.
  std::vector<Pose> standing;
  /// Of the largest consensus, which need not be at the likeliest place.
  int matches = 0, matches_kept = 0, consensus = 0, upper_bound = 0, runner_up_consensus = 0;
  bool certified = false;
  double voxel = 0;          ///< metres, as requested
  double contradiction = 0;  ///< see CloudFit; of the likeliest place
  double missing = 0;        ///< the same
  double log_odds = 0;       ///< see CloudRegistration; of the likeliest place
  bool little = false;       ///< most of what was seen is not there
  std::string reason;
  std::string map_fault;  ///< see TrackedScan; nothing was found then
  std::int64_t nodes = 0;
  double search_ms = 0, total_ms = 0;  ///< CPU
  /// Seconds of CPU that it takes about, by the points described and the matches looked at: the same on every
  /// machine.
  double cost_s = 0;
};

/// Searches places by certified 4DOF registration. Deterministic: the budget counts nodes, not seconds.
/// Remembers the last few targets, which are asked for again and again.
class PlaceFinder {
 public:
  PlaceFinder();
  ~PlaceFinder();
  PlaceFinder(PlaceFinder&&) noexcept;
  PlaceFinder& operator=(PlaceFinder&&) noexcept;
  RecoveryAnswer find(const RecoveryRequest& request);
  /// Describes a target ahead of the searches in it, where their sources turn out dense enough for its voxel.
  void prepare(const SearchTarget& target);

  static constexpr std::size_t kTargets = 6;  ///< remembered, of some megabytes each

 private:
  struct Target;
  /// What making it costs, where it is not known already, is added to `cost_s`.
  Target& known(const SearchTarget& wanted, double* cost_s);
  std::vector<std::unique_ptr<Target>> targets_;  ///< the one that was asked for last comes last
};

}  // namespace scanlock
