// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "global/seen_space.hpp"
#include "search/kd_tree.hpp"

namespace scanlock {

/// Fewer points of steep surfaces are weak evidence.
inline constexpr std::size_t kFewSteep = 100;

/// How well two clouds agree at a pose between them.
struct CloudFit {
  /// Share of the points of one cloud that lie less than half a voxel from the plane of a surface of the
  /// other cloud with a similar normal: the larger of the shares in the two directions, because one cloud may
  /// cover more. Points of level surfaces, which fit everywhere, are left out if the cloud has enough steep
  /// points, and so are points above the highest cell that the other cloud observed in their column, because
  /// sensors differ in the height that they cover.
  double overlap = 0;
  double residual = 0;  ///< metres: median distance of the points near any surface from its plane
  /// Share of points in free space of the other cloud, which its rays crossed, among the points that are
  /// there or on a surface (see ContradictionOf). Points of moving objects, which other rays of their own
  /// cloud crossed, are not counted.
  double contradiction = 0;
  /// Share of the target's points in free space of the source among those that are there or near a surface of
  /// the source.
  double missing = 0;
  double least_overlap = 0;  ///< as overlap, but the smaller of the shares in the two directions
  std::size_t steep = 0;     ///< points of steep surfaces that the contradiction or the overlap counts
};

/// The cloud whose points the contradiction counts.
enum class ContradictionOf {
  kWorse,  ///< the cloud with the larger share: for two clouds of one kind
  kSource  ///< the source, relative to its points in free space or near any surface of the target: for a scan
           ///< in a map; few points of the map are in cells that rays of the scan crossed, and some of them
           ///< are of objects that have moved since
};

/// A described cloud prepared for comparisons with other clouds.
class CloudCheck {
 public:
  /// `cloud`: thinned by `voxel` (metres), with normals and sensor origins. Must outlive this object.
  CloudCheck(const PointCloud& cloud, double voxel);

  /// The horizontal direction, in the cloud's frame, along which its surfaces constrain a translation least.
  Eigen::Vector3d loose_direction() const;

  const SeenSpace& space() const { return space_; }

  friend CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                          ContradictionOf whose);
  friend CloudFit coarse_fit(const CloudCheck& source, const CloudCheck& target,
                             const Pose& target_from_source, std::size_t count);
  friend std::vector<std::uint16_t> surfaces_met(const CloudCheck& source, const CloudCheck& target,
                                                 const Eigen::Matrix3d& attitude,
                                                 const std::vector<Eigen::Vector3d>& places,
                                                 std::size_t count);

 private:
  struct OneWay {
    double overlap = 0;
    std::size_t on = 0, through = 0, steep = 0;  // samples: on a surface, in free space, steep ones of both
    std::vector<float> distances;                // metres from the plane, of the samples near any surface
    std::size_t compared() const { return on + through; }
    /// Share of samples in free space among those that are there or near any surface.
    double crossed() const;
  };
  /// True if rays of this cloud crossed the sample of the cloud `from` at p, in the frame of this cloud, and
  /// the sample is not of a moving object.
  bool contradicts(const CloudCheck& from, std::size_t sample, const Eigen::Vector3f& p,
                   const Eigen::Matrix3f& rotation) const;
  static OneWay one_way(const CloudCheck& from, const CloudCheck& to, const Pose& to_from_from);

  const PointCloud& cloud_;
  float voxel_;
  KdTree tree_;
  std::vector<std::uint32_t> samples_;
  std::vector<bool> moved_;  // for each sample: other rays of the same cloud crossed it
  SeenSpace space_;
};

/// A coarse fit: overlap and contradiction from source to target alone, over about `count` points of the
/// source, with a tolerance of two voxels.
CloudFit coarse_fit(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                    std::size_t count);

/// For each of `places` (metres): the number of points, of about `count` points of the source rotated by
/// `attitude` and moved to the place, that are within two voxels of a surface of the target.
std::vector<std::uint16_t> surfaces_met(const CloudCheck& source, const CloudCheck& target,
                                        const Eigen::Matrix3d& attitude,
                                        const std::vector<Eigen::Vector3d>& places, std::size_t count);

}  // namespace scanlock
