// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_normals.hpp"

#include <Eigen/Eigenvalues>

namespace scanlock {
namespace {

constexpr int kFewest = 5;

Eigen::Vector3f normal_at(const PointCloud& cloud, const NeighbourLists& neighbours, std::size_t i,
                          float squared_radius) {
  const Eigen::Vector3f centre = cloud.point(i);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  int count = 0;
  for (std::uint32_t e = neighbours.begin[i]; e < neighbours.end[i]; ++e) {
    if (neighbours.squared_distance[e] > squared_radius) continue;
    const Eigen::Vector3d d = (cloud.point(neighbours.index[e]) - centre).cast<double>();
    sum += d;
    moment += d * d.transpose();
    ++count;
  }
  if (count < kFewest) return Eigen::Vector3f::Zero();
  const Eigen::Vector3d mean = sum / count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moment / count - mean * mean.transpose());
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[2])) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  return normal.dot(centre) > 0 ? Eigen::Vector3f(-normal) : normal;
}

}  // namespace

void add_normals(PointCloud* cloud, const NeighbourLists& neighbours, float radius) {
  const bool own = cloud->has_normals();
  for (std::vector<float>* v : {&cloud->nx, &cloud->ny, &cloud->nz}) v->resize(cloud->size(), 0.0f);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    Eigen::Vector3f normal = own ? cloud->normal(i) : normal_at(*cloud, neighbours, i, radius * radius);
    const float length = normal.norm();
    normal = length > 1e-6f && length < 1e6f ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::Zero();
    cloud->nx[i] = normal.x();
    cloud->ny[i] = normal.y();
    cloud->nz[i] = normal.z();
  }
}

}  // namespace scanlock
