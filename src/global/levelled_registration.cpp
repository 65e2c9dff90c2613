// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The registration of clouds whose vertical axis is any direction of their frames.
#include <stdexcept>

#include "geometry/moved_cloud.hpp"
#include "geometry/rigid.hpp"
#include "global/cloud_registration.hpp"

namespace scanlock {

CloudDescription describe_levelled(const PointCloud& cloud, const Eigen::Vector3d& up,
                                   const DescriptionOptions& options) {
  if (!up.allFinite() || !(up.norm() > 0))
    throw std::invalid_argument("describe_levelled: up must be finite and not 0 0 0");
  const Eigen::Matrix3d level = level_rotation(up);
  return describe(level.isIdentity(1e-12) ? cloud : moved(cloud, Pose(level)), options);
}

CloudRegistration register_levelled(const CloudDescription& source, const CloudDescription& target,
                                    const Eigen::Vector3d& up, const CloudRegistrationOptions& options) {
  CloudRegistration result = register_clouds(source, target, options);
  const Pose level(level_rotation(up));
  for (Pose* pose : {&result.start, &result.target_from_source, &result.solution.target_from_source,
                     &result.solution.runner_up}) {
    *pose = level.inverse() * *pose * level;
  }
  return result;
}

CloudRegistration register_raw_clouds(const PointCloud& source, const PointCloud& target,
                                      const Eigen::Vector3d& up, const DescriptionOptions& description,
                                      const CloudRegistrationOptions& options) {
  DescriptionOptions common = description;
  if (!(common.voxel > 0)) common.voxel = description_voxel(target);
  return register_levelled(describe_levelled(source, up, common), describe_levelled(target, up, common), up,
                           options);
}

}  // namespace scanlock
