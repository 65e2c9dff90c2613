// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/rigid.hpp"
#include "global/cloud_check.hpp"
#include "global/cloud_description.hpp"
#include "global/hypothesis.hpp"
#include "global/surface_fit.hpp"
#include "icp/cloud_alignment.hpp"

namespace scanlock {

/// The paper's lambda: number of nearest descriptors that a keypoint may match.
inline constexpr int kMostMatches = 10;

/// Refines poses between two described clouds, and measures how well the clouds fit there. Search trees and
/// matches are computed once, on first use.
class CloudPair {
 public:
  /// The clouds must outlive this object. `epsilon`: metres, the inlier threshold of a match. `judged`: see
  /// CloudRegistrationOptions. `target_check`: see register_clouds().
  CloudPair(const CloudDescription& source, const CloudDescription& target, double epsilon, bool judged,
            const CloudCheck* target_check);

  /// The result of match() for the two descriptions; `lambda` at most kMostMatches.
  Matches matches(int lambda);

  /// The pose refined with all matches, then with the clouds, and the fit of the clouds there. Unless it is
  /// the `first`, a pose with a contradiction of 0.5 or more is not refined with the clouds.
  Hypothesis examine(const Pose& pose, int consensus, bool first);

  /// The best `count` poses by the surfaces of the clouds, see surface_poses(); to be passed to examine().
  /// `ups`: directions of the target's frame that may be the source's z axis; empty: the z axis.
  std::vector<Pose> likely_poses(const std::vector<Eigen::Vector3d>& ups, std::size_t count);

  /// Whether the clouds fit about as well after a shift along the loose direction, as in a tunnel, which
  /// looks alike along its whole length. `hypothesis`: a result of examine().
  bool slides(const Hypothesis& hypothesis) const;

  /// separation() of hypothesis.hpp, with the centre and epsilon of this pair.
  double separation(const Pose& a, const Pose& b) const;
  const Eigen::Vector3d& centre() const { return centre_; }  ///< of the source, metres

  double matching_ms() const { return matching_ms_; }  ///< CPU time so far
  double refinement_ms() const { return refinement_ms_; }

 private:
  const std::vector<SurfaceMatch>& all_matches();
  Pose middle_pose(const Pose& start);
  Pose surface_pose(const Pose& pose);
  Pose refined(const Pose& start, const CloudFit& at_start, std::uint32_t* degenerate_axes);
  void index_clouds();
  CloudFit fit(const Pose& target_from_source) const;  ///< of the indexed clouds
  void compare_clouds(bool first, Hypothesis* hypothesis);

  const CloudDescription &source_, &target_;
  double epsilon_;
  bool judged_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  std::vector<SurfaceMatch> matches_;
  std::optional<CloudTarget> index_;
  PointCloud some_of_source_;  // points for refinements unless judged
  std::optional<CloudCheck> source_check_, own_target_check_;
  const CloudCheck* target_check_;  // null until first use
  double matching_ms_ = 0, refinement_ms_ = 0;
};

}  // namespace scanlock
