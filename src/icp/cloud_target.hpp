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

/// Sets the unit normals of `cloud`, each fitted to the `neighbours` nearest points (the point itself
/// included), zero where these span no plane. Normals point towards `viewpoint` (metres, frame of the cloud);
/// without one their sign is arbitrary. `tree`: of the cloud. `threads` does not change the result. Normals
/// that the cloud already has are normalised and kept, except those that are zero or NaN.
void estimate_normals(PointCloud* cloud, const KdForest& tree, int neighbours, int threads,
                      const Eigen::Vector3f* viewpoint = nullptr);

/// The finite points of a cloud, shifted such that the centre of their bounding box is the origin, where
/// floats are most precise, and in an order that keeps neighbours together. Normals are kept, other
/// attributes dropped.
struct CentredCloud {
  PointCloud points;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< metres, in the cloud's own frame
  double diagonal = 0;                               ///< of the bounding box, metres
};
CentredCloud centred(const PointCloud& cloud);

/// A cloud prepared as the target of any number of alignments: its search tree, its normals, and the scales
/// that the paper derives from the target alone.
class CloudTarget {
 public:
  static constexpr int kNormalNeighbours = 15;
  /// Number of neighbours for the normals of a cloud thinned to one point per `voxel` (metres; 0: not
  /// thinned): fewer for the means of voxels, which are less noisy and farther apart.
  static int normal_neighbours(double voxel) { return voxel > 0 ? 10 : kNormalNeighbours; }

  /// Throws std::invalid_argument when fewer than three points are finite. `threads` does not change the
  /// result.
  explicit CloudTarget(const PointCloud& cloud, int threads = 1);

  /// Prepares the normals that methods with distances to planes require: normalises those of the cloud and
  /// estimates missing ones from `neighbours` points, pointing towards `viewpoint` (metres, in the cloud's
  /// own frame) if it is given.
  void prepare_normals(int threads = 1, const Eigen::Vector3d* viewpoint = nullptr,
                       int neighbours = kNormalNeighbours);

  const PointCloud& points() const { return cloud_.points; }  ///< relative to centre()
  bool normals_ready() const { return normals_ready_; }
  const KdForest& tree() const { return tree_; }
  const Eigen::Vector3d& centre() const { return cloud_.centre; }
  double diagonal() const { return cloud_.diagonal; }

  /// Median over the points of the median distance to six neighbours (section 4.3), metres.
  double spacing() const { return spacing_; }
  /// spacing / (3 sqrt 3), the point-to-point rule, metres; never below float resolution.
  double point_nu_min() const { return point_nu_min_; }
  /// Section 5: a sixth of the median over the points of the median distance of six neighbours to the tangent
  /// plane of the point, metres. Valid after prepare_normals().
  double plane_nu_min() const { return plane_nu_min_; }

 private:
  /// One of the points for the scales, and its nearest neighbours.
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
