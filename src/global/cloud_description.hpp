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
  kSpread,  ///< evenly over all surfaces that are not level, for level ones look alike everywhere
  kIss      ///< intrinsic shape signatures, as in the paper
};

/// How to describe a cloud. Radii are in voxels, so that nothing here depends on the scale of the scene.
struct DescriptionOptions {
  double voxel = 0;  ///< metres; 0: description_voxel() of the cloud
  KeypointChoice choice = KeypointChoice::kSpread;
  std::size_t keypoints = 800;  ///< at most, for kSpread
  double normal_radius = 2.5, feature_radius = 6;
  double salient_radius = 3, suppression_radius = 1.5;  ///< for kIss
  /// Adds to the 33 columns of FPFH two that do not change when a levelled cloud turns and moves: the height
  /// above the ground nearby, and the vertical component of the normal.
  bool levelled = true;
};

/// The match set of section 6.1: ISS keypoints and FPFH alone; match it with lambda = 10.
DescriptionOptions paper_description();

/// The keypoints and descriptors of a cloud, which can be matched with any number of other descriptions.
struct CloudDescription {
  PointCloud points;                     ///< thinned, with normals, in the cloud's own levelled frame
  std::vector<std::uint32_t> keypoints;  ///< indices into points, ascending
  Descriptors descriptors;               ///< a row for each keypoint
  double voxel = 0;                      ///< metres
  DescriptionOptions options;            ///< how it was made
  double points_ms = 0, keypoints_ms = 0, features_ms = 0;  ///< CPU of this thread
};

/// The voxel, metres, to which a cloud is thinned to about six thousand points (a small one to fewer): fine
/// enough for shapes, coarse enough for equal density near and far. 0 for a cloud without extent.
double description_voxel(const PointCloud& cloud);

/// Describes a cloud whose z axis points up. Unless it brings normals, they look to where its
/// points were seen from. Descriptions are to be matched with others of the same voxel and options.
/// Deterministic, and independent of the order of the points but for ties. Throws std::invalid_argument for
/// options out of range.
CloudDescription describe(const PointCloud& cloud, const DescriptionOptions& options = {});

/// Candidate correspondences: pairs of keypoints, each among the `lambda` nearest of the other in
/// descriptors.
Matches match(const CloudDescription& source, const CloudDescription& target, int lambda = 4);
/// The same pairs, with the normals at their points and their rank.
std::vector<SurfaceMatch> match_surfaces(const CloudDescription& source, const CloudDescription& target,
                                         int lambda);

/// The description with every n-th keypoint.
CloudDescription part(const CloudDescription& whole, std::size_t stride);
/// The same points, described anew: radius in voxels, keypoints at most.
CloudDescription redescribed(const CloudDescription& old, double feature_radius, std::size_t keypoints);

}  // namespace scanlock
