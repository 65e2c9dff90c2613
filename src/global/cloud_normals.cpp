// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_normals.hpp"

#include <vector>

#include "geometry/symmetric_eigen.hpp"
#include "global/neighbour_lists.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kFewestOfPlane = 5;

Eigen::Vector3f normal_at(const PointCloud& cloud, const NeighbourFinder::Neighbours& near, std::size_t i) {
  if (near.count() < kFewestOfPlane) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f centre = cloud.point(i);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (std::uint32_t index : near.index) {
    const Eigen::Vector3d d = (cloud.point(index) - centre).cast<double>();
    sum += d;
    moment += d * d.transpose();
  }
  const auto count = static_cast<double>(near.count());
  const Eigen::Vector3d mean = sum / count;
  const SymmetricEigen<3> eigen = symmetric_eigen(Eigen::Matrix3d(moment / count - mean * mean.transpose()));
  if (!(eigen.values[1] > 1e-9 * eigen.values[2])) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f normal = eigen.vectors.col(0).cast<float>();
  return normal.dot(centre - cloud.eye(i)) > 0 ? Eigen::Vector3f(-normal) : normal;
}

}  // namespace

void add_normals(PointCloud* cloud, float radius) {
  std::vector<Eigen::Vector3f> normals(cloud->size(), Eigen::Vector3f::Zero());
  if (cloud->has_normals()) {
    for (std::size_t i = 0; i < cloud->size(); ++i) normals[i] = cloud->normal(i);
  } else {
    NeighbourFinder finder(*cloud, radius);
    for (std::uint32_t i : finder.order()) normals[i] = normal_at(*cloud, finder.about(i), i);
  }
  for (std::vector<float>* v : {&cloud->nx, &cloud->ny, &cloud->nz}) v->resize(cloud->size(), 0.0f);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const float length = normals[i].norm();
    const Eigen::Vector3f normal =
        length > 1e-6f && length < 1e6f ? Eigen::Vector3f(normals[i] / length) : Eigen::Vector3f::Zero();
    cloud->nx[i] = normal.x();
    cloud->ny[i] = normal.y();
    cloud->nz[i] = normal.z();
  }
}

}  // namespace scanlock
