// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "search/kd_forest.hpp"

namespace scanlock {

/// The unit normals of `cloud` from each point's `neighbours` nearest (itself included), zero where they span
/// no plane. With `viewpoint` they look towards it; without, their sign means nothing. `tree` is of that
/// cloud; `threads` does not change the answer. Normals that the cloud has already are normalised and kept,
/// but for those that are zero or NaN.
void estimate_normals(PointCloud* cloud, const KdForest& tree, int neighbours, int threads,
                      const Eigen::Vector3f* viewpoint = nullptr);

/// The finite points of a cloud, shifted so that the centre of their bounding box is the origin: floats are
/// precise there. They come in an order that keeps neighbours together.
struct CentredCloud {
  PointCloud points;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< metres, in the cloud's own frame
  double diagonal = 0;                               ///< of the bounding box, metres
};
CentredCloud centred(const PointCloud& cloud);

/// A cloud made ready to be aligned to, as often as one likes: its index, its normals, and the scales that
/// the paper derives from it alone.
class CloudTarget {
 public:
  static constexpr int kNormalNeighbours = 15;
  /// How many neighbours make the normals of a cloud thinned to a point a `voxel` (0: not thinned): the means
  /// of voxels are less noisy, and far apart.
  static int normal_neighbours(double voxel) { return voxel > 0 ? 10 : kNormalNeighbours; }

  /// Throws std::invalid_argument when fewer than three points are finite. `threads` does not change the
  /// answers.
  explicit CloudTarget(const PointCloud& cloud, int threads = 1);

  /// What the methods for planes need: the cloud's own normals are made unit, and what is missing is
  /// estimated from so many `neighbours`, looking towards `viewpoint` (in the cloud's own frame) where one is
  /// known.
  void prepare_normals(int threads = 1, const Eigen::Vector3d* viewpoint = nullptr,
                       int neighbours = kNormalNeighbours);

  const PointCloud& points() const { return cloud_.points; }  ///< relative to centre()
  bool normals_ready() const { return normals_ready_; }
  const KdForest& tree() const { return tree_; }
  const Eigen::Vector3d& centre() const { return cloud_.centre; }
  double diagonal() const { return cloud_.diagonal; }

  /// Median over the points of the median distance to six neighbours (section 4.3), metres.
  double spacing() const { return spacing_; }
  /// spacing / (3 sqrt 3): the point-to-point rule; never below what floats resolve.
  double point_nu_min() const { return point_nu_min_; }
  /// Section 5, after prepare_normals(): a sixth of the median over the points of the median distance of six
  /// neighbours to their tangent plane.
  double plane_nu_min() const { return plane_nu_min_; }

 private:
  /// A point and its neighbours, from which the scales are medians.
  struct Sample {
    static constexpr int kNeighbours = 6;
    std::size_t point = 0;
    int count = 0;
    std::array<std::size_t, kNeighbours> neighbours{};
  };
  template <typename Distance>
  double median_over_samples(const Distance& distance) const;
  double least_nu() const;
  CentredCloud cloud_;
  KdForest tree_;
  std::vector<Sample> samples_;
  bool normals_ready_ = false;
  double spacing_ = 0, point_nu_min_ = 0, plane_nu_min_ = 0;
};

}  // namespace scanlock
