// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/cloud_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "geometry/moved_cloud.hpp"
#include "geometry/voxel_grid.hpp"
#include "mapping/solid_cloud.hpp"
#include "odometry/motion_filter.hpp"

namespace scanlock {
namespace {

constexpr float kFinest = 0.1F;       // metres: a voxel that hides what is behind it
constexpr float kEye = 1.2F;          // metres above the floor
constexpr float kHeadroom = 1.5F;     // metres that are free above a floor
constexpr float kFloorCell = 0.5F;    // metres
constexpr float kStep = 0.4F;         // metres from one cell of a floor to the next: a kerb, a steep ramp
constexpr double kLeastFloor = 0.05;  // of the widest one: what is less is a roof or a table
constexpr double kRows = 40, kTurn = 180;  // rays, from 40 degrees below the horizon to 40 above, and around
constexpr double kSteepest = 40 * kDegree;
constexpr double kLevel = 8 * kDegree;  // rays flatter than this tell the reach
constexpr std::size_t kLeastSeen = 50;  // points that stand on the floor: a roof and a bare field have none

using Cell = std::pair<int, int>;

Cell cell_of(const Eigen::Vector3f& p, float size) {
  return {static_cast<int>(std::floor(p.x() / size)), static_cast<int>(std::floor(p.y() / size))};
}

/// Middles of cells, on what has headroom above it there.
struct Floor {
  std::vector<Eigen::Vector3f> places;
  std::map<Cell, std::vector<std::uint32_t>> cells;
};

Floor find_floor(const PointCloud& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto cell = [&](std::uint32_t i) { return cell_of(points.point(i), kFloorCell); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Cell one = cell(a), other = cell(b);
    return one != other ? one < other : points.z[a] < points.z[b];
  });
  Floor floor;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool last = i + 1 == order.size() || cell(order[i + 1]) != cell(order[i]);
    if (!last && points.z[order[i + 1]] - points.z[order[i]] < kHeadroom) continue;
    const Cell here = cell(order[i]);
    floor.cells[here].push_back(static_cast<std::uint32_t>(floor.places.size()));
    floor.places.emplace_back((static_cast<float>(here.first) + 0.5F) * kFloorCell,
                              (static_cast<float>(here.second) + 0.5F) * kFloorCell, points.z[order[i]]);
  }
  return floor;
}

/// Of places that hang together by small steps, those of wide floors.
std::vector<std::uint32_t> wide_floors(const Floor& floor) {
  std::vector<int> part(floor.places.size(), -1);
  std::vector<std::size_t> sizes;
  for (std::uint32_t seed = 0; seed < part.size(); ++seed) {
    if (part[seed] >= 0) continue;
    const int number = static_cast<int>(sizes.size());
    std::vector<std::uint32_t> border{seed};
    part[seed] = number;
    std::size_t size = 0;
    while (!border.empty()) {
      const std::uint32_t at = border.back();
      border.pop_back();
      ++size;
      const auto [x, y] = cell_of(floor.places[at], kFloorCell);
      for (int near = 0; near < 9; ++near) {
        const auto next = floor.cells.find({x + near / 3 - 1, y + near % 3 - 1});
        if (next == floor.cells.end()) continue;
        for (const std::uint32_t other : next->second) {
          if (part[other] >= 0 || std::abs(floor.places[other].z() - floor.places[at].z()) > kStep) continue;
          part[other] = number;
          border.push_back(other);
        }
      }
    }
    sizes.push_back(size);
  }
  std::vector<std::uint32_t> wide;
  if (sizes.empty()) return wide;
  const double least = kLeastFloor * static_cast<double>(*std::max_element(sizes.begin(), sizes.end()));
  for (const auto& [cell, places] : floor.cells) {
    for (const std::uint32_t place : places)
      if (static_cast<double>(sizes[static_cast<std::size_t>(part[place])]) >= least) wide.push_back(place);
  }
  return wide;
}

/// Whether an eye there has the width of a robot around it.
bool is_free(const SolidCloud& solid, const Eigen::Vector3f& eye) {
  constexpr float step = 0.3F;  // metres
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      if (solid.is_solid(eye + step * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0)))
        return false;
  return true;
}

std::vector<Eigen::Vector3f> ray_directions() {
  std::vector<Eigen::Vector3f> rays;
  for (double row = 0; row < kRows; ++row) {
    const SineCosine up = sincos(kSteepest * (2 * (row + 0.5) / kRows - 1));
    for (double i = 0; i < kTurn; ++i) {
      const SineCosine turn = sincos(2 * kPi * i / kTurn);
      rays.push_back(Eigen::Vector3d(up.cosine * turn.cosine, up.cosine * turn.sine, up.sine).cast<float>());
    }
  }
  return rays;
}

struct View {
  PointCloud points;  // relative to the eye
  double reach = 0;
  std::size_t standing = 0;  // points above the middle between eye and floor
};

View seen_from(const SolidCloud& solid, const Eigen::Vector3f& eye, const std::vector<Eigen::Vector3f>& rays,
               float range) {
  std::vector<std::uint32_t> hits;
  std::vector<float> ranges;
  const auto level = static_cast<float>(sin(kLevel));
  for (const Eigen::Vector3f& ray : rays) {
    const std::optional<std::uint32_t> hit = solid.hit(eye, ray, range);
    if (!hit) continue;
    hits.push_back(*hit);
    if (std::abs(ray.z()) < level) ranges.push_back((solid.points().point(*hit) - eye).norm());
  }
  std::sort(hits.begin(), hits.end());
  hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
  View view;
  for (const std::uint32_t i : hits) {
    view.points.push_back(solid.points().point(i) - eye);
    view.standing += view.points.z.back() > -0.5F * kEye ? 1 : 0;
  }
  if (ranges.empty()) return view;
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  view.reach = static_cast<double>(*middle);
  return view;
}

/// Eyes that were taken.
class Eyes {
 public:
  /// Whether one of them shows the ground around `eye`: it is near, and sees it.
  bool cover(const SolidCloud& solid, const Eigen::Vector3f& eye) const {
    const auto [x, y] = cell_of(eye, kCell);
    for (int i = x - 1; i <= x + 1; ++i) {
      for (int j = y - 1; j <= y + 1; ++j) {
        const auto cell = cells_.find({i, j});
        if (cell == cells_.end()) continue;
        for (const auto& [other, radius] : cell->second) {
          const Eigen::Vector3f way = other - eye;
          const float distance = way.norm();
          if (distance < radius && !solid.hit(eye, way / std::max(distance, 1e-6F), distance)) return true;
        }
      }
    }
    return false;
  }
  void add(const Eigen::Vector3f& eye, double reach) {
    const auto radius = std::min(static_cast<float>(2 * kSameSpot * reach), kCell);
    cells_[cell_of(eye, kCell)].emplace_back(eye, radius);
  }

 private:
  static constexpr float kCell = 10;  // metres: no eye shows the ground around one that is farther off
  std::map<Cell, std::vector<std::pair<Eigen::Vector3f, float>>> cells_;
};

}  // namespace

SavedMap map_of_cloud(const PointCloud& cloud, const std::string& name, const CloudMapOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const Eigen::Matrix3d level = level_rotation(options.up);
  PointCloud levelled;
  levelled.x = cloud.x;
  levelled.y = cloud.y;
  levelled.z = cloud.z;
  levelled = moved(levelled, Pose(level));
  const SolidCloud solid(levelled, kFinest);
  const Floor floor = find_floor(solid.points());
  const std::vector<std::uint32_t> places = wide_floors(floor);
  const std::vector<Eigen::Vector3f> rays = ray_directions();
  const auto range = static_cast<float>(options.max_range_m);
  Eyes eyes;
  KeyframeArchive archive(std::numeric_limits<std::size_t>::max());
  std::uint64_t done = 0;
  for (const std::uint32_t place : places) {
    if (progress) progress(++done, places.size());
    const Eigen::Vector3f eye = floor.places[place] + kEye * Eigen::Vector3f::UnitZ();
    if (!is_free(solid, eye) || eyes.cover(solid, eye)) continue;
    const View view = seen_from(solid, eye, rays, range);
    if (view.standing < kLeastSeen) continue;
    eyes.add(eye, view.reach);
    Pose map_from_eye = Pose(level.transpose());
    map_from_eye.translation() = level.transpose() * eye.cast<double>();
    const auto utime = static_cast<std::int64_t>(archive.keyframes().size() + 1);
    archive.add(utime, map_from_eye, view.reach, view.points);
  }
  SavedMap map;
  map.keyframes = archive.keyframes();
  if (map.keyframes.empty())
    throw std::runtime_error(name + ": no floor in it that a robot could stand on and see " +
                             std::to_string(kLeastSeen) +
                             " points of what stands there; is up another axis (map.up)?");
  map.last_pose = map.keyframes.front().map_from_body;
  map.up = options.up.normalized();
  for (const ArchivedKeyframe& k : map.keyframes)
    map.constraints.push_back({0, k.id, k.map_from_body, Matrix6::Identity() / (kPoseFloor * kPoseFloor)});
  return map;
}

PointCloud cloud_of_map(const SavedMap& map, float voxel) {
  PointCloud all;
  for (const ArchivedKeyframe& k : map.keyframes) {
    for (std::size_t i = 0; i < k.points->size(); ++i)
      all.push_back((k.map_from_body * k.points->point(i).cast<double>()).cast<float>());
  }
  return select(all, thin_by_voxel(all, voxel));
}

}  // namespace scanlock
