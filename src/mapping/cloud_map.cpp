// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/cloud_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "geometry/moved_cloud.hpp"
#include "geometry/parallel.hpp"
#include "geometry/voxel_grid.hpp"
#include "mapping/floor.hpp"
#include "odometry/motion_filter.hpp"

namespace scanlock {
namespace {

// Metres: edge of the smallest voxel, which occludes the space behind it.
constexpr float kFinest = 0.1F;
constexpr float kEye = 1.2F;  // metres: height of the simulated sensor (eye) above the floor
// Rays per column, from 40 degrees below the horizon to 40 above, and per row.
constexpr double kRows = 40, kTurn = 180;
constexpr double kSteepest = 40 * kDegree;
constexpr double kLevel = 8 * kDegree;  // the reach is the median range of rays flatter than this
// Points higher than half the eye's height: a roof and a bare field have none.
constexpr std::size_t kLeastSeen = 50;
constexpr double kClearly = 3;  // standard deviations of a difference of two counts
// Cells: lamps, and objects that hang over the edge of a table, cover fewer.
constexpr std::size_t kMuch = 20;
// Largest plausible ratio of the area in a side view to that in the top view: a tunnel has 1.2, a corridor
// 1.3.
constexpr float kTall = 1.5F;

std::string square_metres(float area) {
  return std::to_string(std::lround(area)) + " m2";
}

std::string thousands(const Eigen::Vector3f& point) {
  std::string text;
  for (const float coordinate : point)
    text += (text.empty() ? "" : ",") +
            std::to_string(1000 * std::llround(1e-3 * static_cast<double>(coordinate)));
  return text;
}

float area_of(std::size_t cells, float size) {
  return static_cast<float>(cells) * size * size;
}

/// Areas, in square metres, of the cloud's projections along x, y and z.
Eigen::Array3f shadows(const SolidCloud& solid) {
  const float edge = solid.block_edge();
  std::array<std::vector<Cell>, 3> cells;
  for (const SolidCloud::BlockId block : solid.blocks()) {
    const Eigen::Vector3f p = solid.middle_of(block);
    cells[0].push_back(cell_of({p.y(), p.z(), 0}, edge));
    cells[1].push_back(cell_of({p.x(), p.z(), 0}, edge));
    cells[2].push_back(cell_of(p, edge));
  }
  Eigen::Array3f areas;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::sort(cells[axis].begin(), cells[axis].end());
    const auto end = std::unique(cells[axis].begin(), cells[axis].end());
    areas[static_cast<Eigen::Index>(axis)] =
        area_of(static_cast<std::size_t>(end - cells[axis].begin()), edge);
  }
  return areas;
}

/// The reasons to doubt the given upward direction, one sentence each.
std::vector<std::string> doubts_about(const SolidCloud& solid, const Floors& floors) {
  std::vector<std::string> doubts;
  const Eigen::Array3f areas = shadows(solid);
  if (areas.head<2>().maxCoeff() > kTall * areas.z())
    doubts.push_back("seen from a side it covers " + square_metres(areas.head<2>().maxCoeff()) +
                     ", from above only " + square_metres(areas.z()) +
                     ": is another axis up (map.up, --up)?");
  const auto below = static_cast<double>(floors.rough_below), above = static_cast<double>(floors.rough_above);
  if (floors.open && below - above > kClearly * std::sqrt(below + above))
    doubts.emplace_back("its upper side is smoother than its lower one: is it upside down (map.up, --up)?");
  if (floors.hanging > floors.standing + kMuch)
    doubts.push_back("more surface hangs from its ceilings (" +
                     square_metres(area_of(floors.hanging, kFloorCell)) + ") than stands on its floors (" +
                     square_metres(area_of(floors.standing, kFloorCell)) +
                     "): is it upside down (map.up, --up)?");
  return doubts;
}

/// Whether the voxels around `eye` are free for the width of a robot (0.6 m).
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
  std::size_t standing = 0;  // points higher than half way from the floor to the eye
};

View seen_from(const SolidCloud& solid, const Eigen::Vector3f& eye, const std::vector<Eigen::Vector3f>& rays,
               float range, int threads) {
  std::vector<std::optional<SolidCloud::Voxel>> hit(rays.size());
  for_each_chunk(rays.size(), kChunk, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hit[i] = solid.hit(eye, rays[i], range);
  });
  std::vector<SolidCloud::Voxel> hits;
  std::vector<float> ranges;
  const auto level = static_cast<float>(sin(kLevel));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hit[i]) continue;
    hits.push_back(*hit[i]);
    if (std::abs(rays[i].z()) < level) ranges.push_back((solid.point(*hit[i]) - eye).norm());
  }
  std::sort(hits.begin(), hits.end(),
            [&](SolidCloud::Voxel a, SolidCloud::Voxel b) { return solid.is_before(a, b); });
  hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
  View view;
  for (const SolidCloud::Voxel i : hits) {
    view.points.push_back(solid.point(i) - eye);
    view.standing += view.points.z.back() > -0.5F * kEye ? 1 : 0;
  }
  if (ranges.empty()) return view;
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  view.reach = static_cast<double>(*middle);
  return view;
}

/// The eyes at which keyframes were made.
class Eyes {
 public:
  /// Whether one of them is near `eye` and in its line of sight: it shows the same ground.
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
  static constexpr float kCell = 10;  // metres: the largest distance at which two eyes show the same ground
  std::map<Cell, std::vector<std::pair<Eigen::Vector3f, float>>> cells_;
};

}  // namespace

CloudMapBuilder::CloudMapBuilder(const CloudMapOptions& options)
    : options_(options), level_(level_rotation(options.up)), solid_(kFinest) {}

void CloudMapBuilder::add(PointCloud part) {
  points_ += part.size();
  for (std::size_t i = 0; i < part.size() && !first_finite_; ++i)
    if (part.point(i).allFinite()) first_finite_ = part.point(i);
  part.nx.clear();  // normals are not needed, and moved() would rotate them
  solid_.add(moved(std::move(part), Pose(level_) * options_.map_from_cloud));
}

SavedMap CloudMapBuilder::build(const std::string& name,
                                const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  if (points_ == 0) throw std::runtime_error(name + ": holds no points");
  if (solid_.not_finite() == points_)
    throw std::runtime_error(name + ": none of its " + std::to_string(points_) + " points is finite");
  if (solid_.size() == 0)
    throw std::runtime_error(name + ": none of its " + std::to_string(points_) +
                             " points is within 100 km of its origin; subtract an offset from them: "
                             "scanlock-convert " +
                             name + " SITE.map --offset " + thousands(*first_finite_));
  if (solid_.not_finite() + solid_.too_far() > 0)
    warnings_.push_back("of its " + std::to_string(points_) + " points, " +
                        std::to_string(solid_.not_finite()) + " that are not finite and " +
                        std::to_string(solid_.too_far()) +
                        " that are farther than 100 km from its origin are left out");
  solid_.close();
  const Floors floors = find_floors(solid_);
  for (std::string& doubt : doubts_about(solid_, floors)) warnings_.push_back(std::move(doubt));
  const std::vector<FloorPlace> places = wide_floors(floors.places);
  const std::vector<Eigen::Vector3f> rays = ray_directions();
  const auto range = static_cast<float>(options_.max_range_m);
  Eyes viewpoints;
  KeyframeArchive archive(std::numeric_limits<std::size_t>::max());
  // Heights of eyes that saw fewer than kLeastSeen points, by squares of 2 x 2 cells: of the cells in such a
  // square, on a roof or a bare field, only one is tried.
  std::map<Cell, float> barren;
  std::uint64_t done = 0;
  float swept = -std::numeric_limits<float>::infinity();  // x, metres: the cloud below it was removed
  for (const FloorPlace& place : places) {
    if (progress) progress(++done, places.size());
    if (const float behind = place.middle().x() - range; behind - swept > range) {
      solid_.forget_below(behind);
      swept = behind;
    }
    const Eigen::Vector3f eye = place.middle() + kEye * Eigen::Vector3f::UnitZ();
    const auto nothing = barren.find(cell_of(eye, 2 * kFloorCell));
    if (nothing != barren.end() && std::abs(nothing->second - eye.z()) < kFloorStep) continue;
    if (!is_free(solid_, eye)) continue;
    if (viewpoints.cover(solid_, eye)) continue;
    const View view = seen_from(solid_, eye, rays, range, options_.threads);
    if (view.standing < kLeastSeen) {
      barren[cell_of(eye, 2 * kFloorCell)] = eye.z();
      continue;
    }
    viewpoints.add(eye, view.reach);
    Pose map_from_eye = Pose(level_.transpose());
    map_from_eye.translation() = level_.transpose() * eye.cast<double>();
    const auto utime = static_cast<std::int64_t>(archive.keyframes().size() + 1);
    archive.add(utime, map_from_eye, view.reach, view.points);
  }
  solid_ = SolidCloud(kFinest);  // the caller needs the memory to write the map
  SavedMap map;
  map.keyframes = archive.keyframes();
  if (map.keyframes.empty())
    throw std::runtime_error(
        name + ": no floor on which a robot would see " + std::to_string(kLeastSeen) +
        " points of upright surfaces; is its unit not metres, or is another axis up (map.up, --up)?");
  map.last_pose = map.keyframes.front().map_from_body;
  map.up = options_.up.normalized();
  for (const ArchivedKeyframe& k : map.keyframes)
    map.constraints.push_back({0, k.id, k.map_from_body, Matrix6::Identity() / (kPoseFloor * kPoseFloor)});
  return map;
}

SavedMap map_of_cloud(const PointCloud& cloud, const std::string& name, const CloudMapOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  CloudMapBuilder builder(options);
  builder.add(cloud);
  return builder.build(name, progress);
}

PointCloud cloud_of_map(const SavedMap& map, float voxel) {
  ThinnedCloud all(voxel);
  for (const ArchivedKeyframe& k : map.keyframes) {
    const std::shared_ptr<const PointCloud> points = k.points.cloud();
    for (std::size_t i = 0; i < points->size(); ++i)
      all.points().push_back((k.map_from_body * points->point(i).cast<double>()).cast<float>());
    all.settle();
  }
  return all.take();
}

}  // namespace scanlock
