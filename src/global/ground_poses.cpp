// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/ground_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "global/attitude_search.hpp"
#include "global/cloud_normals.hpp"
#include "global/ground_height.hpp"

namespace scanlock {
namespace {

constexpr double kStep = 2;            // voxels between two places: the tolerance of a coarse score
constexpr std::size_t kHeadings = 72;  // bins
constexpr std::size_t kMostTurns = 8;
// Ratio of the best to the mean agreement, below which the agreement determines no heading. It is 1.00
// to 1.01 in woods, 1.3 and more in streets, rooms, car parks and on meadows.
constexpr double kAlike = 1.25;
// Largest numbers of poses (places in all attitudes), which limit the time to a tenth of a second of first
// scores. More places are thinned by a larger step.
constexpr std::size_t kMostOfEyes = 40000, kMostOfGround = 360000;
constexpr double kWiderStep = 1.1;  // least factor of the step

using Headings = std::array<double, kHeadings>;

/// Histogram of the headings of the normals of steep surfaces.
Headings headings(const PointCloud& cloud) {
  Headings result{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_steep(cloud, i)) continue;
    const double turn = atan2(cloud.ny[i], cloud.nx[i]) / (2 * kPi) + 0.5;
    result[static_cast<std::size_t>(turn * kHeadings) % kHeadings] += 1;
  }
  return result;
}

/// The yaw angles, radians, at which the headings agree best, the best first. All angles where none stands
/// out, as among trunks, whose normals have all headings.
std::vector<double> likely_turns(const Headings& source, const Headings& target) {
  Headings agreement{};
  for (std::size_t turn = 0; turn < kHeadings; ++turn) {
    for (std::size_t i = 0; i < kHeadings; ++i) agreement[turn] += source[i] * target[(i + turn) % kHeadings];
  }
  std::vector<double> turns;
  const double mean = std::accumulate(agreement.begin(), agreement.end(), 0.0) / kHeadings;
  if (*std::max_element(agreement.begin(), agreement.end()) < kAlike * mean) {
    for (std::size_t k = 0; k < kHeadings; ++k) turns.push_back(2 * kPi * static_cast<double>(k) / kHeadings);
    return turns;
  }
  std::vector<std::size_t> peaks;
  for (std::size_t k = 0; k < kHeadings; ++k) {
    if (agreement[k] >= agreement[(k + 1) % kHeadings] &&
        agreement[k] > agreement[(k + kHeadings - 1) % kHeadings])
      peaks.push_back(k);
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [&](std::size_t a, std::size_t b) { return agreement[a] > agreement[b]; });
  peaks.resize(std::min(peaks.size(), kMostTurns));
  for (std::size_t k : peaks) {
    // The top of the parabola through the bin and its neighbours.
    const double before = agreement[(k + kHeadings - 1) % kHeadings], after = agreement[(k + 1) % kHeadings];
    const double bend = before - 2 * agreement[k] + after;
    const double top = bend < 0 ? 0.5 * (before - after) / bend : 0;
    turns.push_back(2 * kPi * (static_cast<double>(k) + top) / kHeadings);
  }
  return turns;
}

/// Places thinned to one per square lattice cell and step of height.
class Lattice {
 public:
  explicit Lattice(double step) : step_(step) {}
  /// Adds the cell that is `dx` and `dy` steps beside the place.
  void add(const Eigen::Vector3f& place, int dx = 0, int dy = 0) {
    places_.push_back({cell(place.x()) + dx, cell(place.y()) + dy, place.z()});
  }

  /// In a fixed order.
  std::vector<Eigen::Vector3d> places() {
    std::sort(places_.begin(), places_.end());
    std::vector<Eigen::Vector3d> result;
    const Place* last = nullptr;
    for (const Place& place : places_) {
      const double z = static_cast<double>(place.z);
      if (last && last->x == place.x && last->y == place.y && z - result.back().z() < step_) continue;
      last = &place;
      result.emplace_back((place.x + 0.5) * step_, (place.y + 0.5) * step_, z);
    }
    return result;
  }

 private:
  struct Place {
    int x, y;
    float z;
    bool operator<(const Place& other) const {
      return std::tie(x, y, z) < std::tie(other.x, other.y, other.z);
    }
  };
  int cell(float v) const { return static_cast<int>(std::floor(static_cast<double>(v) / step_)); }

  double step_;
  std::vector<Place> places_;
};

/// The sensor origins of the cloud, and the places one step beside them.
std::vector<Eigen::Vector3d> places_of_eyes(const PointCloud& cloud, double step) {
  Lattice lattice(step);
  std::set<std::array<float, 3>> viewpoints;  // few, each shared by many points
  for (const Eigen::Vector3f& eye : cloud.viewpoints) {
    if (!viewpoints.insert({eye.x(), eye.y(), eye.z()}).second) continue;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) lattice.add(eye, dx, dy);
    }
  }
  return lattice.places();
}

/// The places `height` metres above upward surfaces that are in free space.
std::vector<Eigen::Vector3d> places_above_ground(const PointCloud& cloud, const SeenSpace& space,
                                                 float height, double step) {
  Lattice lattice(step);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f place = cloud.point(i) + height * Eigen::Vector3f::UnitZ();
    if (cloud.nz[i] >= kLevel && space.was_seen_through(place)) lattice.add(place);
  }
  return lattice.places();
}

/// Adds the places that `places_by` returns for a step; at most `most` (1 at least), with a larger step where
/// there are more.
template <typename PlacesBy>
void add_at_most(std::size_t most, double step, const PlacesBy& places_by,
                 std::vector<Eigen::Vector3d>* places) {
  std::vector<Eigen::Vector3d> more = places_by(step);
  while (more.size() > std::max<std::size_t>(most, 1)) {
    const double times =
        static_cast<double>(more.size()) / static_cast<double>(std::max<std::size_t>(most, 1));
    more = places_by(step *= std::max(kWiderStep, std::sqrt(times)));
  }
  places->insert(places->end(), more.begin(), more.end());
}

}  // namespace

GroundPoses ground_poses(const PointCloud& source, const PointCloud& target, const SeenSpace& space,
                         double voxel, const std::vector<Eigen::Vector3d>& ups) {
  GroundPoses poses;
  const std::vector<double> turns = likely_turns(headings(source), headings(target));
  for (const Eigen::Vector3d& up : ups_or_z(ups)) {
    for (double turn : turns)
      poses.attitudes.push_back(level_rotation(up).transpose() * rotation_about_z(turn));
  }
  if (poses.attitudes.empty()) return poses;
  const auto by_eyes = [&](double step) { return places_of_eyes(target, step); };
  add_at_most(kMostOfEyes / poses.attitudes.size(), kStep * voxel, by_eyes, &poses.places);
  const auto height = height_above_ground(source, kGroundCell * static_cast<float>(voxel));
  if (!height) return poses;
  const auto by_ground = [&](double step) { return places_above_ground(target, space, *height, step); };
  add_at_most(kMostOfGround / poses.attitudes.size(), kStep * voxel, by_ground, &poses.places);
  return poses;
}

}  // namespace scanlock
