// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "search/kd_forest.hpp"

namespace scanlock {

/// The plane or the line that the neighbourhood of a point lies on. It goes through the centroid of the
/// neighbours, which is less noisy than the point itself; a plane whose neighbours are spread by more than
/// 0.05 m about it (ground and the foot of a wall are) through the point, for the centroid is off what the
/// point lies on.
struct Surface {
  /// Unit, of the plane; to where it was seen from, where the cloud tells that.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< metres
  float weight = 0;   ///< 0: nothing there, to 1: flat and spread in both directions, or straight and thin
  bool line = false;  ///< `normal` is the direction of a line instead
  float scale = 1;    ///< of residuals: a surface thicker than 0.05 m (standard deviation) says less
  /// Standard deviations of a plane's normal, radians: towards where it is known least, as a vector, and
  /// across that.
  Eigen::Vector3f tilt = Eigen::Vector3f::Zero();
  float tilt_across = 0;
};

/// What stands alone, a post, a bush or the end of a car, as an upright line as thick as its points are
/// apart: the neighbours are all that is near, the nearest first, the point itself. No surface where one is
/// farther off than `reach`, horizontally. It is taken to be `least` metres thick at least (a standard
/// deviation).
Surface fit_post(const PointCloud& cloud, const Neighbour* neighbours, int count, float reach, float least);

/// Surfaces of the points of a map, fitted when they are first asked for: a scan meets only a part of the
/// map.
class LocalSurfaces {
 public:
  static constexpr int kNeighbours = 14;

  /// Forgets all fits. Cloud and tree (of that cloud) must outlive this object's use; `radius`: neighbours
  /// farther than this many metres do not count, and where those make no plane none farther than twice that.
  /// Where the cloud has eyes, planes that were seen edge-on weigh less, for most of them are the fan of a
  /// beam and no part of the scene.
  /// `walls`: the cloud was seen by a planar sensor, see fit_wall().
  void reset(const PointCloud& cloud, const KdForest& tree, float radius, bool walls = false);

  /// The cloud has grown at its end; the fits of what was there stay.
  void grow();

  /// Fits what is missing among the points at `indices` (negative ones are skipped). The result does not
  /// depend on `threads`.
  void prepare(const std::vector<std::int32_t>& indices, int threads);

  /// The surface at a prepared point.
  const Surface& at(std::int32_t index) const { return surfaces_[static_cast<std::size_t>(index)]; }

 private:
  Surface fit(std::int32_t index) const;
  /// What is rather a line than a plane is one if it stands upright (z): trunks and poles, which are all that
  /// fixes a heading in a forest. Lines across are left alone, for they are the rings of the sensor and no
  /// part of the scene.
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
/// Its scale is 0.05 m over its thickness, sqrt(l3) or of a line sqrt(l2 + l3), one at most.
Surface fit_surface(const PointCloud& cloud, const Neighbour* neighbours, int count);

/// The upright plane through neighbours that a level sensor saw in its one plane; weight 0 when there are
/// fewer than five. The weight is the square of (sqrt(l1) - sqrt(l2)) / sqrt(l1) of their covariance in x and
/// y.
Surface fit_wall(const PointCloud& cloud, const Neighbour* neighbours, int count);

}  // namespace scanlock
