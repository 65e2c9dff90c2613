// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "geometry/moved_cloud.hpp"
#include "global/attitude_search.hpp"
#include "global/cloud_check.hpp"
#include "global/cloud_normals.hpp"
#include "global/cloud_registration.hpp"
#include "global/cpu_clock.hpp"
#include "odometry/planar_part.hpp"

namespace scanlock {
namespace {

constexpr double kKeypoints = 1000;    // of the source; the target has as many per area
constexpr double kMostIsThere = 0.85;  // overlap from which on the map does not lack much of the source
// Least share of the source's points that have enough neighbours: for a sensor of few points a wider voxel
// (kWider times) is more informative.
constexpr double kDescribed = 0.4, kWider = 1.35;
constexpr int kWidenings = 2;
// Points of steep surfaces from which on the source has enough of them, as some are not in the map.
constexpr std::size_t kEnoughSteep = 2 * kFewSteep;
// The estimate of the CPU time, seconds: per search, per point of the map that is looked at, per point that
// is described, per point that is gathered for a description, and per match. For 289 searches in five
// buildings it was 0.7 to 1.2 times the measured time (for a few 1.6).
constexpr double kSecondsASearch = 0.25, kSecondsALook = 1.8e-6, kSecondsAPoint = 4e-6,
                 kSecondsARawPoint = 1e-7, kSecondsAMatch = 15e-9;
constexpr std::size_t kMaxNodes = 20000;      // per search: some tenths of a second
constexpr std::size_t kMaxWork = 40'000'000;  // of all searches for one answer: 0.8 s

std::size_t steep_points(const PointCloud& cloud) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) count += is_steep(cloud, i) ? 1 : 0;
  return count;
}

CloudDescription describe_with(const PointCloud& cloud, double voxel) {
  DescriptionOptions options;
  options.voxel = voxel;
  options.keypoints = static_cast<std::size_t>(kKeypoints);
  return describe(cloud, options);
}

/// Uses a wider voxel than `voxel` where points lie too far apart for it. If `finer`, uses a finer one where
/// that leaves enough points of steep surfaces, as of parked cars on open ground, and `voxel` does not.
CloudDescription describe_source(const PointCloud& cloud, double voxel, bool finer) {
  CloudDescription description = describe_with(cloud, voxel);
  if (finer && steep_points(description.points) < kEnoughSteep) {
    CloudDescription closer = describe_with(cloud, voxel / (kWider * kWider));
    if (steep_points(closer.points) >= kEnoughSteep) return closer;
  }
  for (int widened = 0; widened < kWidenings; ++widened) {
    const double most = std::min(kKeypoints, static_cast<double>(description.points.size()));
    if (static_cast<double>(description.keypoints.size()) >= kDescribed * most) break;
    voxel *= kWider;
    description = describe_with(cloud, voxel);
  }
  return description;
}

}  // namespace

bool same_place(const Pose& a, const Pose& b, const Pose& predicted, double times) {
  return near(a * predicted, b * predicted, times * kSamePlace, times * kSameHeading);
}

double together(std::vector<double> log_odds) {
  std::sort(log_odds.begin(), log_odds.end(), std::greater<>());
  double sum = 0;
  for (std::size_t k = 0; k < log_odds.size(); ++k) {
    const double share = log_odds[k] > 0 ? 2.0 / static_cast<double>((k + 1) * (k + 2)) : k > 0 ? 0.5 : 1.0;
    sum += share * log_odds[k];
  }
  return sum;
}

/// A part of the map prepared for searches, and the inputs that it depends on.
struct PlaceFinder::Target {
  Target(const SearchTarget& wanted, bool planar);
  bool is_of(const SearchTarget& wanted) const {
    const auto same = [](const auto& place, const ArchivedKeyframe& k) {
      return place.first == k.utime && place.second.matrix() == k.map_from_body.matrix();
    };
    return centre == wanted.centre && source_radius == wanted.source_radius && radius == wanted.radius &&
           voxel == wanted.voxel && up == wanted.up &&
           std::equal(places.begin(), places.end(), wanted.places.begin(), wanted.places.end(), same);
  }
  const CloudCheck& check() {
    if (!check_) check_.emplace(description.points, description.voxel);
    return *check_;
  }

  Eigen::Vector3d centre;
  double source_radius, radius, voxel;
  Eigen::Vector3d up;
  std::vector<std::pair<std::int64_t, Pose>> places;
  std::optional<PlanarPart> plane;  ///< of planar sensors; otherwise the description
  CloudDescription description;
  std::size_t raw_points = 0;  ///< points that were gathered for it

 private:
  std::optional<CloudCheck> check_;
};

PlaceFinder::PlaceFinder() = default;
PlaceFinder::~PlaceFinder() = default;
PlaceFinder::PlaceFinder(PlaceFinder&&) noexcept = default;
PlaceFinder& PlaceFinder::operator=(PlaceFinder&&) noexcept = default;

PlaceFinder::Target::Target(const SearchTarget& wanted, bool planar)
    : centre(wanted.centre),
      source_radius(wanted.source_radius),
      radius(wanted.radius),
      voxel(wanted.voxel),
      up(wanted.up) {
  for (const ArchivedKeyframe& k : wanted.places) places.emplace_back(k.utime, k.map_from_body);
  if (planar) {
    plane.emplace(wanted);
    return;
  }
  DescriptionOptions options;
  options.voxel = wanted.voxel;
  const double wider = std::min(radius / std::max(source_radius, 1e-3), kWidestPart);
  options.keypoints = static_cast<std::size_t>(kKeypoints * wider * wider);
  description = describe(
      moved(submap_around(wanted.places, centre, radius, wanted.voxel), Pose(level_rotation(up))), options);
  for (const ArchivedKeyframe* k : keyframes_seeing(wanted.places, centre, radius))
    raw_points += k->points.size();
}

PlaceFinder::Target& PlaceFinder::known(const SearchTarget& wanted, bool planar, double* cost_s) {
  const auto found = std::find_if(targets_.begin(), targets_.end(), [&](const auto& target) {
    return target->is_of(wanted) && target->plane.has_value() == planar;
  });
  if (found != targets_.end()) {
    std::rotate(found, found + 1, targets_.end());
    return *targets_.back();
  }
  if (targets_.size() == kTargets) targets_.erase(targets_.begin());
  targets_.push_back(std::make_unique<Target>(wanted, planar));
  Target& target = *targets_.back();
  *cost_s += target.plane ? target.plane->cost_s()
                          : kSecondsAPoint * static_cast<double>(target.description.points.size()) +
                                kSecondsARawPoint * static_cast<double>(target.raw_points);
  return target;
}

void PlaceFinder::prepare(const SearchTarget& target) {
  double cost_s = 0;
  const bool planar = PlanarPart::applies(target);
  Target& known_target = known(target, planar, &cost_s);
  if (!planar) known_target.check();
}

RecoveryAnswer PlaceFinder::find(const RecoveryRequest& request) {
  CpuClock clock;
  if (request.planar && PlanarPart::applies(request.target)) {
    double cost_s = 0;
    RecoveryAnswer answer = known(request.target, true, &cost_s).plane->find(request);
    answer.cost_s += cost_s;
    answer.total_ms = clock.lap();
    return answer;
  }
  const Eigen::Matrix3d level = level_rotation(request.target.up);
  // Without a measured attitude the source is levelled by the z axis of the body: slopes tilt the body, and
  // the robot may now stand on another slope than where it was lost.
  const Eigen::Matrix3d stand = level_rotation(request.source_up.value_or(request.body_up));
  const CloudDescription source =
      describe_source(moved(request.source, Pose(stand)), request.target.voxel, request.finer);
  double cost_s = kSecondsASearch + kSecondsAPoint * static_cast<double>(source.points.size());
  SearchTarget wanted = request.target;
  wanted.voxel = source.voxel;
  Target& target = known(wanted, false, &cost_s);
  cost_s += kSecondsALook * static_cast<double>(target.description.points.size());

  CloudRegistrationOptions registration;
  registration.tilt = request.tilt;
  registration.max_nodes = kMaxNodes;
  registration.max_work = kMaxWork;
  registration.judged = false;
  // source: stand (p - source_centre); target: level (p - target_centre).
  const Pose to_stand = Pose(stand) * Eigen::Translation3d(-request.source_centre);
  const Pose to_level = Pose(level) * Eigen::Translation3d(-request.target.centre);
  for (const Pose& pose : request.undecided)
    registration.proposals.push_back(to_level * pose * to_stand.inverse());
  for (const Eigen::Vector3d& up : request.body_ups) registration.target_ups.push_back(level * up);
  const CloudRegistration found = register_clouds(source, target.description, registration, &target.check());

  RecoveryAnswer answer;
  answer.serial = request.serial;
  answer.utime = request.utime;
  answer.voxel = request.target.voxel;
  answer.contradiction = found.fit.contradiction;
  answer.missing = found.fit.missing;
  answer.certified = found.solution.certified;
  if (answer.certified && found.verdict != GlobalVerdict::kNoOverlap) answer.verdict = PlaceVerdict::kFound;
  answer.little = found.fit.overlap < kLittleOverlap;
  answer.log_odds = found.log_odds;
  const auto correction = [&](const Pose& target_from_source) -> Pose {
    return to_level.inverse() * target_from_source * to_stand;
  };
  answer.map_from_predicted = correction(found.target_from_source);
  for (const Pose& runner_up : found.runners_up) answer.runners_up.push_back(correction(runner_up));
  for (const Hypothesis& place : found.uncontradicted) {
    if (place.fit.overlap < kMostIsThere) answer.uncontradicted.push_back(correction(place.refined));
  }
  answer.matches = static_cast<int>(found.solution.matches);
  answer.matches_kept = static_cast<int>(found.solution.matches_after_pruning);
  answer.consensus = found.solution.consensus;
  answer.upper_bound = found.solution.upper_bound;
  answer.runner_up_consensus = found.solution.runner_up_consensus;
  answer.reason = found.why;
  if (!answer.certified && answer.consensus >= kFewestMatches)
    answer.reason += ", not proven to be the largest consensus";
  answer.nodes = static_cast<std::int64_t>(found.solution.nodes);
  answer.cost_s = cost_s + kSecondsAMatch * static_cast<double>(found.solution.work);
  answer.search_ms = found.solution.pruning_ms + found.solution.search_ms;
  answer.total_ms = clock.lap();
  return answer;
}

}  // namespace scanlock
