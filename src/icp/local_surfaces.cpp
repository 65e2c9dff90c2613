// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/local_surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/elementary.hpp"
#include "geometry/parallel.hpp"
#include "geometry/symmetric_eigen.hpp"

namespace scanlock {
namespace {

constexpr double kUpright = 0.8;  // cosine of 37 degrees
// Standard deviations of the neighbours about their line or plane, metres:
constexpr double kThread = 0.03;  // thinner neighbourhoods are a line of the scan pattern, or a plane
constexpr double kThin = 0.05;
constexpr double kLeastNoise = 0.015;  // metres, noise of ranges: a smaller one among few points is chance
constexpr int kFewest = 5;             // neighbours
// Least thickness assumed for a post, as a share of the radius: the map keeps one point per voxel, whose edge
// is a quarter of the radius, and a uniform distribution over half an edge has this standard deviation.
constexpr float kUnsure = 0.125f / 3.4641f;
// Weight of a plane whose points spread half as far across as along. It limits the cost: to refit planes of
// more weight with a wider neighbourhood changes the errors little and takes a tenth to a third more time.
constexpr float kMostlyALine = 0.25f;
constexpr float kGrazing = 0.1f;  // sine of the angle between ray and plane below which a plane weighs less

/// The distribution of neighbours about their centroid, in the first kAxes of x, y and z.
template <int kAxes>
struct Spread {
  Spread(const PointCloud& cloud, const Neighbour* neighbours, int count) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, kAxes, kAxes> moment = Eigen::Matrix<double, kAxes, kAxes>::Zero();
    const Eigen::Vector3f origin = cloud.point(static_cast<std::size_t>(neighbours[0].index));
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector3d p =
          (cloud.point(static_cast<std::size_t>(neighbours[k].index)) - origin).cast<double>();
      mean += p;
      moment += p.head<kAxes>() * p.head<kAxes>().transpose();
    }
    mean /= count;
    moment = moment / count - mean.head<kAxes>() * mean.head<kAxes>().transpose();
    const SymmetricEigen<kAxes> eigen = symmetric_eigen(moment);
    own = origin;
    centre = mean.cast<float>() + origin;
    deviation = eigen.values.cwiseMax(0.0).cwiseSqrt();
    axes = eigen.vectors;
    // A fit to n neighbours leaves n - kAxes degrees of freedom for the noise.
    const double noise =
        std::max(deviation[0] * std::sqrt(count / static_cast<double>(count - kAxes)), kLeastNoise);
    noise_of_mean = noise / std::sqrt(static_cast<double>(count));
  }
  /// Standard deviation (radians) of the first axis towards axis `other`, if the distances of the neighbours
  /// from their plane are independent noise: the perturbation of an eigenvector, sqrt(l1 lk / n) / (lk - l1).
  double tilt(int other) const {
    const double apart = deviation[other] * deviation[other] - deviation[0] * deviation[0];
    return std::min(noise_of_mean * deviation[other] / std::max(apart, 1e-12), 1.0);
  }
  Eigen::Vector3f own, centre;                ///< the first neighbour, the centroid of all; metres
  Eigen::Matrix<double, kAxes, 1> deviation;  ///< metres, ascending
  Eigen::Matrix<double, kAxes, kAxes> axes;   ///< in columns, in the same order
  double noise_of_mean;                       ///< metres, of the centroid along the first axis
};

/// See fit_surface(), and with `lines` LocalSurfaces::fit_plane_or_line().
Surface surface_of(const Spread<3>& spread, bool lines) {
  Surface surface;
  const Eigen::Vector3d& deviation = spread.deviation;
  if (!(deviation[2] > 0)) return surface;
  const double planarity = std::clamp((deviation[1] - deviation[0]) / deviation[2], 0.0, 1.0);
  surface.normal = spread.axes.col(0).cast<float>();
  surface.weight = static_cast<float>(planarity * planarity);
  surface.scale = static_cast<float>(std::min(1.0, kThin / deviation[0]));
  // The centroid of neighbours on the ground and on the foot of a wall lies on neither of the two.
  surface.centre = surface.scale < 1 ? spread.own : spread.centre;
  surface.tilt = (spread.tilt(1) * spread.axes.col(1)).cast<float>();
  surface.tilt_across = static_cast<float>(spread.tilt(2));
  const double linearity = 1.0 - deviation[1] / deviation[2];
  const Eigen::Vector3d direction = spread.axes.col(2);
  const double thickness = hypot(deviation[0], deviation[1]);
  if (lines && linearity > planarity && std::abs(direction.z()) > kUpright && thickness > kThread) {
    surface.line = true;
    surface.normal = direction.cast<float>();
    surface.centre = spread.centre;
    surface.weight = static_cast<float>(linearity * linearity);
    surface.scale = static_cast<float>(std::min(1.0, kThin / thickness));
  }
  return surface;
}

/// True if at most a fifth of the points between the ends of a line are beside it.
bool stands_alone(const PointCloud& cloud, const Surface& line, const Neighbour* own, int count,
                  const Neighbour* around, int around_count) {
  const auto off = [&](const Neighbour& n) -> Eigen::Vector3f {
    return cloud.point(static_cast<std::size_t>(n.index)) - line.centre;
  };
  float reach = 0, width = 0;
  for (int k = 0; k < count; ++k) {
    const float along = line.normal.dot(off(own[k]));
    reach = std::max(reach, std::abs(along));
    width = std::max(width, (off(own[k]) - along * line.normal).norm());
  }
  int level = 0, beside = 0;
  for (int k = 0; k < around_count; ++k) {
    const float along = line.normal.dot(off(around[k]));
    if (std::abs(along) > reach) continue;
    ++level;
    if ((off(around[k]) - along * line.normal).norm() > 1.5f * width) ++beside;
  }
  return beside * 5 <= level;
}

/// Factor of a plane's weight. The points of a single scan line across clutter lie in a plane, but in the one
/// that the beam sweeps, which the sensor sees edge-on, and not in one of the scene.
float edge_on_weight(const Surface& plane, const Eigen::Vector3f& eye) {
  const float cosine = plane.normal.dot((plane.centre - eye).normalized());
  return std::min(1.0f, cosine * cosine / (kGrazing * kGrazing));
}

}  // namespace

Surface fit_surface(const PointCloud& cloud, const Neighbour* neighbours, int count) {
  return count < kFewest ? Surface() : surface_of(Spread<3>(cloud, neighbours, count), false);
}

Surface fit_wall(const PointCloud& cloud, const Neighbour* neighbours, int count) {
  Surface surface;
  if (count < kFewest) return surface;
  const Spread<2> spread(cloud, neighbours, count);
  const Eigen::Vector2d& deviation = spread.deviation;
  if (!(deviation[1] > 0)) return surface;
  surface.normal.head<2>() = spread.axes.col(0).cast<float>();
  surface.centre = spread.centre;
  surface.tilt.head<2>() = (spread.tilt(1) * spread.axes.col(1)).cast<float>();
  const double linearity = 1.0 - deviation[0] / deviation[1];
  surface.weight = static_cast<float>(linearity * linearity);
  return surface;
}

Surface fit_post(const PointCloud& cloud, const Neighbour* neighbours, int count, float reach, float least) {
  Surface surface;
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  const Eigen::Vector3f own = cloud.point(static_cast<std::size_t>(neighbours[0].index));
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector2f off = (cloud.point(static_cast<std::size_t>(neighbours[k].index)) - own).head<2>();
    if (off.squaredNorm() > reach * reach) return surface;
    mean += off;
  }
  mean /= static_cast<float>(count);
  float moment = 0;
  for (int k = 0; k < count; ++k)
    moment += (cloud.point(static_cast<std::size_t>(neighbours[k].index)) - own).head<2>().squaredNorm();
  const float apart = std::sqrt(std::max(moment / static_cast<float>(count) - mean.squaredNorm(), 0.0f));
  surface.line = true;
  surface.normal = Eigen::Vector3f::UnitZ();
  surface.centre = own;
  surface.centre.head<2>() += mean;
  surface.weight = 1;
  surface.scale = std::min(1.0f, static_cast<float>(kThin) / std::sqrt(apart * apart + least * least));
  return surface;
}

void LocalSurfaces::reset(const PointCloud& cloud, const KdForest& tree, float radius, bool walls) {
  cloud_ = &cloud;
  tree_ = &tree;
  radius_ = radius;
  walls_ = walls;
  surfaces_.assign(cloud.size(), Surface{});
  fitted_.assign(cloud.size(), 0);
}

void LocalSurfaces::grow() {
  surfaces_.resize(cloud_->size());
  fitted_.resize(cloud_->size(), 0);
}

void LocalSurfaces::prepare(const std::vector<std::int32_t>& indices, int threads) {
  missing_.clear();
  for (std::int32_t index : indices) {
    if (index < 0 || fitted_[static_cast<std::size_t>(index)]) continue;
    fitted_[static_cast<std::size_t>(index)] = 1;
    missing_.push_back(index);
  }
  for_each_chunk(missing_.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      surfaces_[static_cast<std::size_t>(missing_[i])] = fit(missing_[i]);
  });
}

Surface LocalSurfaces::fit(std::int32_t index) const {
  const auto at = static_cast<std::size_t>(index);
  std::array<Neighbour, kNeighbours> near;
  const int count = tree_->k_nearest(cloud_->point(at), kNeighbours, near.data(), radius_);
  Surface surface =
      walls_ ? fit_wall(*cloud_, near.data(), count) : fit_plane_or_line(at, near.data(), count);
  if (cloud_->has_viewpoints() && !surface.line) {
    surface.weight *= edge_on_weight(surface, cloud_->viewpoints[at]);
    if (surface.normal.dot(cloud_->viewpoints[at] - surface.centre) < 0) surface.normal = -surface.normal;
  }
  if (cloud_->is_alone(at) && count > 0 && count < kNeighbours) {
    const Surface post = fit_post(*cloud_, near.data(), count, 0.5f * radius_, kUnsure * radius_);
    if (post.scale * post.scale * post.weight > surface.weight) surface = post;
  }
  return surface;
}

Surface LocalSurfaces::fit_plane_or_line(std::size_t at, const Neighbour* near, int count) const {
  std::array<Neighbour, 3 * kNeighbours> around;
  int wide = 0;
  const auto look_around = [&] {
    if (wide == 0) wide = tree_->k_nearest(cloud_->point(at), 3 * kNeighbours, around.data(), 2.0f * radius_);
  };
  Surface surface;
  if (count >= kFewest) {
    const Spread<3> spread(*cloud_, near, count);
    surface = surface_of(spread, true);
    if (surface.line) {
      // A line of the scan pattern on a wall has further lines beside it; a trunk has none.
      look_around();
      if (stands_alone(*cloud_, surface, near, count, around.data(), wide)) return surface;
      surface = surface_of(spread, false);
    }
    if (spread.deviation[0] >= kThread || surface.weight >= kMostlyALine) return surface;
  }
  // Where the rings of the sensor are far apart, the nearest points are all on one ring: a wider
  // neighbourhood determines the plane better, if all of it lies on one plane.
  look_around();
  if (wide < kFewest) return surface;
  const Spread<3> spread(*cloud_, around.data(), wide);
  const Surface wider = surface_of(spread, false);
  return spread.deviation[0] < kThread && wider.weight > surface.weight ? wider : surface;
}

}  // namespace scanlock
