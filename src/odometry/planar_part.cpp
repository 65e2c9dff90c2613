// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/planar_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/moved_cloud.hpp"
#include "global/cpu_clock.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {
namespace {

constexpr double kCell = 0.5;  // of the voxel of the search
// The estimate of the CPU time, seconds: per cell of the tables, and per sample that is looked up.
constexpr double kSecondsACell = 4e-8, kSecondsALookup = 1e-9;

/// Levels the plane of the sensor, of which `body_up` is the normal.
Pose levelled_about(const Eigen::Vector3d& centre, const Eigen::Vector3d& body_up) {
  return Pose(level_rotation(body_up)) * Eigen::Translation3d(-centre);
}

Pose levelled_from_map(const SearchTarget& target) {
  return levelled_about(target.centre, target.places.front().map_from_body.linear().col(2));
}

/// Metres: a part that is too large for a grid has larger cells.
double cell_for(const PointCloud& cloud, double voxel) {
  if (cloud.empty()) return kCell * voxel;
  const auto [left, right] = std::minmax_element(cloud.x.begin(), cloud.x.end());
  const auto [near, far] = std::minmax_element(cloud.y.begin(), cloud.y.end());
  return std::max(kCell * voxel,
                  static_cast<double>(std::max(*right - *left, *far - *near)) / OccupancyGrid::kMostCells);
}

}  // namespace

bool PlanarPart::applies(const SearchTarget& target) {
  return !target.places.empty() && is_planar(*target.places.front().points.cloud());
}

PlanarPart::PlanarPart(const SearchTarget& target)
    : PlanarPart(moved(submap_around(target.places, target.centre, target.radius, kCell * target.voxel),
                       Pose(levelled_from_map(target).linear())),
                 target, levelled_from_map(target)) {}

PlanarPart::PlanarPart(const PointCloud& cloud, const SearchTarget& target, const Pose& level_from_map)
    : level_from_map_(level_from_map),
      map_(OccupancyGrid(cloud, cell_for(cloud, target.voxel)), target.source_radius) {}

double PlanarPart::cost_s() const {
  return kSecondsACell * (map_.size() + 2 * map_.border()).cast<double>().prod();
}

RecoveryAnswer PlanarPart::find(const RecoveryRequest& request) const {
  CpuClock clock;
  const Pose level_from_predicted = levelled_about(request.source_centre, request.body_up);
  const OccupancyGrid source(moved(request.source, Pose(level_from_predicted.linear())), map_.cell());
  OccupancySearchOptions options;
  options.log_odds = kMostOfScans;
  options.distance = 2 * kSamePlace;
  options.angle = 2 * kSameHeading;
  options.places = kMostPlaces;
  const OccupancyMatches found = search_occupancy(source, map_, options);
  RecoveryAnswer answer;
  answer.serial = request.serial;
  answer.utime = request.utime;
  answer.voxel = request.target.voxel;
  answer.matches = answer.matches_kept = found.samples;
  answer.nodes = static_cast<std::int64_t>(found.nodes);
  answer.cost_s = kSecondsALookup * static_cast<double>(found.work);
  answer.search_ms = answer.total_ms = clock.lap();
  answer.upper_bound = static_cast<int>(std::lround(found.upper_bound));
  answer.runner_up_consensus = static_cast<int>(std::lround(found.rival_bound));
  if (found.poses.empty()) {
    answer.certified = found.finished;
    answer.reason = "no pose has three tenths of the possible log-likelihood ratio";
    return answer;
  }
  for (const OccupancyMatch& match : found.poses) {
    const Pose correction = level_from_map_.inverse() * Eigen::Translation3d(match.x, match.y, 0) *
                            Pose(rotation_about_z(match.yaw)) * level_from_predicted;
    if (&match == &found.poses.front()) {
      answer.map_from_predicted = correction;
    } else if (lead_odds(found, match.log_likelihood) < kBelieved) {
      answer.runners_up.push_back(correction);
    }
  }
  const OccupancyMatch& best = found.poses.front();
  answer.verdict = PlaceVerdict::kFound;
  answer.certified = true;
  answer.consensus = answer.upper_bound;
  answer.log_odds = log_odds(found);
  answer.no_rival = lead_odds(found, found.rival_bound) >= kBelieved;
  answer.little = best.surfaces < kLittleOverlap * found.surfaces;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "%d of %d surfaces meet one of the map; log-likelihood ratio %.0f, at any other place at most "
      "%.0f; log odds %.1f",
      best.surfaces, found.surfaces, best.log_likelihood, found.rival_bound, answer.log_odds);
  answer.reason = text;
  return answer;
}

}  // namespace scanlock
