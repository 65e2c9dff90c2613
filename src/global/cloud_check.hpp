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

/// So few points of steep surfaces say little.
inline constexpr std::size_t kFewSteep = 100;

/// What two clouds say about a pose between them.
struct CloudFit {
  /// Share of the points of one cloud that lie less than half a voxel from the plane of a surface of the
  /// other cloud whose normal is alike. The larger of the shares in the two directions, for one cloud may
  /// reach farther. Level ground, which fits everywhere, is left out where there is anything else, and so are
  /// points above all that the other cloud tells of their column, for sensors differ in how high they see.
  double overlap = 0;
  double residual = 0;  ///< metres: median distance from their plane of the points that are near any surface
  /// Of the points that lie on a surface of the other cloud or in space that its rays crossed, the share of
  /// the latter (see ContradictionOf). Points of moving objects, which other rays of their own cloud crossed,
  /// are not counted.
  double contradiction = 0;
  /// Of the target's points that are near a surface of the source or in space that its rays crossed, the
  /// share of the latter.
  double missing = 0;
  double least_overlap = 0;  ///< as overlap, but the smaller share of the two directions
  std::size_t steep = 0;     ///< points of steep surfaces that the contradiction or the overlap counts
};

/// The cloud whose points the contradiction is counted over.
enum class ContradictionOf {
  kWorse,  ///< the cloud with the greater share: for two clouds of one kind
  kSource  ///< the source, among all of its points that the target tells anything of: for what a robot sees
           ///< in a map, of which few points are where its rays went, and some are of what has moved since
};

/// A described cloud made ready to be compared with others.
class CloudCheck {
 public:
  /// `cloud`: thinned by `voxel` (metres), with normals and where it was seen from. Must outlive this object.
  CloudCheck(const PointCloud& cloud, double voxel);

  /// The horizontal direction, in the cloud's frame, along which its surfaces constrain a translation least.
  Eigen::Vector3d loose_direction() const;

  const SeenSpace& space() const { return space_; }

  friend CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                          ContradictionOf whose);
  friend CloudFit glance(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                         std::size_t count);
  friend std::vector<std::uint16_t> surfaces_met(const CloudCheck& source, const CloudCheck& target,
                                                 const Eigen::Matrix3d& attitude,
                                                 const std::vector<Eigen::Vector3d>& places,
                                                 std::size_t count);

 private:
  struct OneWay {
    double overlap = 0;
    std::size_t on = 0, through = 0, steep = 0;  // samples; the last of both
    std::vector<float> distances;
    std::size_t compared() const { return on + through; }
    /// Of all points that are near any surface or where rays went, the share of the latter.
    double crossed() const;
  };
  /// Whether rays of this cloud went through a sample of the other, which is at p here.
  bool contradicts(const CloudCheck& from, std::size_t sample, const Eigen::Vector3f& p,
                   const Eigen::Matrix3f& rotation) const;
  static OneWay one_way(const CloudCheck& from, const CloudCheck& to, const Pose& to_from_from);

  const PointCloud& cloud_;
  float voxel_;
  KdTree tree_;
  std::vector<std::uint32_t> samples_;
  std::vector<bool> moved_;  // of the samples: rays of the same cloud crossed there at another time
  SeenSpace space_;
};

/// A coarse fit: overlap and contradiction from source to target alone, over about `count` points of the
/// source, with a tolerance of two voxels.
CloudFit glance(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                std::size_t count);

/// For each of the places: of about `count` points of the source, turned by `attitude` and moved to the
/// place, the number within two voxels of a surface of the target.
std::vector<std::uint16_t> surfaces_met(const CloudCheck& source, const CloudCheck& target,
                                        const Eigen::Matrix3d& attitude,
                                        const std::vector<Eigen::Vector3d>& places, std::size_t count);

}  // namespace scanlock
