// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/match.hpp"
#include "geometry/point_cloud.hpp"
#include "global/fpfh.hpp"
#include "global/surface_fit.hpp"

namespace scanlock {

enum class KeypointChoice {
  kSpread,  ///< evenly over all surfaces that are not level: level surfaces look alike everywhere
  kIss      ///< intrinsic shape signatures, as in the paper
};

/// How to describe a cloud. Radii are in voxels, so that nothing here depends on the scale of the scene.
struct DescriptionOptions {
  double voxel = 0;  ///< metres: the cloud is thinned by it; 0: description_voxel() of the cloud
  KeypointChoice choice = KeypointChoice::kSpread;
  std::size_t keypoints = 800;  ///< at most, for kSpread
  double normal_radius = 2.5, feature_radius = 6;
  double salient_radius = 3, suppression_radius = 1.5;  ///< for kIss
  /// Adds two columns to the 33 of FPFH that do not depend on yaw and position of a levelled cloud: the
  /// height above the ground nearby, and the vertical component of the normal.
  bool levelled = true;
};

/// Options for the match set of section 6.1: ISS keypoints and FPFH alone; to be matched with lambda = 10.
DescriptionOptions paper_description();

/// The keypoints and descriptors of a cloud, which can be matched with any number of other descriptions.
struct CloudDescription {
  PointCloud points;                     ///< thinned, with normals, in the cloud's own levelled frame
  std::vector<std::uint32_t> keypoints;  ///< indices into points, ascending
  Descriptors descriptors;               ///< a row for each keypoint
  double voxel = 0;                      ///< metres
  DescriptionOptions options;            ///< those of describe()
  double points_ms = 0, keypoints_ms = 0, features_ms = 0;  ///< CPU time of this thread
};

/// The voxel, metres, that thins a cloud to 8,000 points (a small cloud to 40 % of its points) within a
/// factor of 1.25: fine enough for shapes, coarse enough for equal density near and far. 0 for a cloud
/// without extent.
double description_voxel(const PointCloud& cloud);

/// Describes a cloud whose z axis points up. Normals that the cloud does not have are estimated, pointing
/// towards the sensor origins of the points. Match a description only with others of the same voxel and
/// options. Deterministic, and except for ties independent of the order of the points. Throws
/// std::invalid_argument for options out of range.
CloudDescription describe(const PointCloud& cloud, const DescriptionOptions& options = {});

/// Candidate correspondences: pairs of keypoints, each of which is among the `lambda` nearest of the other by
/// descriptor.
Matches match(const CloudDescription& source, const CloudDescription& target, int lambda = 4);
/// The pairs of match(), with the normals at their points and their ranks.
std::vector<SurfaceMatch> match_surfaces(const CloudDescription& source, const CloudDescription& target,
                                         int lambda);

/// The description with every n-th keypoint.
CloudDescription part(const CloudDescription& whole, std::size_t stride);
/// describe() of the points of `old` with its voxel, another `feature_radius` (voxels), and at most
/// `keypoints` keypoints.
CloudDescription redescribed(const CloudDescription& old, double feature_radius, std::size_t keypoints);

}  // namespace scanlock
