// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "search/kd_forest.hpp"

namespace scanlock {

/// The plane or the line fitted to the neighbourhood of a point. It goes through the centroid of the
/// neighbours, which is less noisy than the point itself. Only a plane about which the neighbours spread by
/// more than 0.05 m (as on the ground at the foot of a wall) goes through the point, because their centroid
/// is off the surface of the point.
struct Surface {
  /// Unit normal of the plane, towards the sensor origin if the cloud has these.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< metres
  float weight = 0;   ///< from 0: no surface, to 1: flat and spread in both directions, or straight and thin
  bool line = false;  ///< true: a line, whose direction is `normal`
  float scale = 1;    ///< factor of residuals, below 1 for surfaces thicker than 0.05 m (standard deviation)
  /// Standard deviations of a plane's normal, radians: along its most uncertain direction, as a vector, and
  /// perpendicular to that.
  Eigen::Vector3f tilt = Eigen::Vector3f::Zero();
  float tilt_across = 0;
};

/// Fits an upright line to an isolated object, as a post, a bush or the end of a car; its thickness is the
/// standard deviation of the points, at least `least` metres. `neighbours`: all points near a point of the
/// object, which is the first of them. No surface (weight 0) where a neighbour is farther than `reach`
/// metres, horizontally.
Surface fit_post(const PointCloud& cloud, const Neighbour* neighbours, int count, float reach, float least);

/// Surfaces of the points of a map, fitted on first use: a scan covers only a part of the map.
class LocalSurfaces {
 public:
  static constexpr int kNeighbours = 14;

  /// Discards all fits. Cloud and tree (of that cloud) must outlive the use of this object. `radius`: metres,
  /// of the neighbourhood; twice as much where the neighbours within it form no plane. Where the cloud has
  /// sensor origins (eyes), planes that were seen edge-on weigh less, because most of them are the plane that
  /// a beam swept and no part of the scene. `walls`: the cloud is from a planar sensor, see fit_wall().
  void reset(const PointCloud& cloud, const KdForest& tree, float radius, bool walls = false);

  /// Extends the storage after points were appended to the cloud; existing fits stay.
  void grow();

  /// Fits the surfaces that are missing at `indices` (negative ones are skipped). The result does not depend
  /// on `threads`.
  void prepare(const std::vector<std::int32_t>& indices, int threads);

  /// The surface at a prepared point.
  const Surface& at(std::int32_t index) const { return surfaces_[static_cast<std::size_t>(index)]; }

 private:
  Surface fit(std::int32_t index) const;
  /// A neighbourhood that is more linear than planar becomes a line only if it is upright (along z), as
  /// trunks and poles are, which alone constrain the heading in a forest. Lines in other directions are not
  /// fitted: they are rings of the sensor and no part of the scene.
  Surface fit_plane_or_line(std::size_t at, const Neighbour* near, int count) const;

  const PointCloud* cloud_ = nullptr;
  const KdForest* tree_ = nullptr;
  float radius_ = 0;
  bool walls_ = false;
  std::vector<Surface> surfaces_;
  std::vector<std::uint8_t> fitted_;
  std::vector<std::int32_t> missing_;
};

/// Fits a surface to the given neighbours of `cloud`, the point itself first; weight 0 when there are fewer
/// than five.
/// The weight of a plane is the square of the planarity (sqrt(l2) - sqrt(l3)) / sqrt(l1) of the
/// neighbourhood's covariance, l1 >= l2 >= l3; that of a line the square of (sqrt(l1) - sqrt(l2)) / sqrt(l1).
/// Its scale is 0.05 m over its thickness, sqrt(l3), or sqrt(l2 + l3) for a line; at most 1.
Surface fit_surface(const PointCloud& cloud, const Neighbour* neighbours, int count);

/// The upright plane through neighbours from a level sensor that scans a single plane; weight 0 when there
/// are fewer than five. The weight is the square of (sqrt(l1) - sqrt(l2)) / sqrt(l1) of their covariance in x
/// and y.
Surface fit_wall(const PointCloud& cloud, const Neighbour* neighbours, int count);

}  // namespace scanlock
