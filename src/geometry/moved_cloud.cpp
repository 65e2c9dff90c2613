// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/moved_cloud.hpp"

namespace scanlock {

PointCloud moved(PointCloud cloud, const Pose& pose) {
  const bool turning_normals = cloud.has_normals();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p = (pose * cloud.point(i).cast<double>()).cast<float>();
    cloud.x[i] = p.x();
    cloud.y[i] = p.y();
    cloud.z[i] = p.z();
    if (!turning_normals) continue;
    const Eigen::Vector3f n = (pose.linear() * cloud.normal(i).cast<double>()).cast<float>();
    cloud.nx[i] = n.x();
    cloud.ny[i] = n.y();
    cloud.nz[i] = n.z();
  }
  for (Eigen::Vector3f& eye : cloud.viewpoints) eye = (pose * eye.cast<double>()).cast<float>();
  return cloud;
}

}  // namespace scanlock
