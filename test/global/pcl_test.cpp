// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of FPFH and ISS against the Point Cloud Library, where that is installed.
#include <doctest/doctest.h>

#ifdef SCANLOCK_TEST_PCL
#include <pcl/features/fpfh.h>
#include <pcl/keypoints/iss_3d.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/voxel_grid.hpp"
#include "global/cloud_normals.hpp"
#include "global/fpfh.hpp"
#include "global/iss_keypoints.hpp"
#include "scenes.hpp"

using namespace scanlock;

namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr pcl_points(const PointCloud& cloud) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr points(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < cloud.size(); ++i) points->push_back({cloud.x[i], cloud.y[i], cloud.z[i]});
  return points;
}

PointCloud scene() {
  const PointCloud cloud = yard(3, 5);
  return select(cloud, thin_by_voxel(cloud, 0.6f));
}

}  // namespace

TEST_CASE("FPFH equals that of the Point Cloud Library") {
  PointCloud cloud = scene();
  const float radius = 3;
  add_normals(&cloud, 1.5f);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    // The library returns other values for normals of zeros.
    if (cloud.normal(i).norm() == 0) cloud.nz[i] = 1;
  }
  pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
  for (std::size_t i = 0; i < cloud.size(); ++i) normals->push_back({cloud.nx[i], cloud.ny[i], cloud.nz[i]});
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
  estimation.setInputCloud(pcl_points(cloud));
  estimation.setInputNormals(normals);
  estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  estimation.setRadiusSearch(static_cast<double>(radius));
  pcl::PointCloud<pcl::FPFHSignature33> theirs;
  estimation.compute(theirs);

  std::vector<std::uint32_t> all(cloud.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const Descriptors ours = fpfh(cloud, radius, all);
  std::size_t differ = 0;
  float largest = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (int b = 0; b < kFpfhSize; ++b) {
      const float off = std::abs(ours(static_cast<Eigen::Index>(i), b) - theirs[i].histogram[b]);
      largest = std::max(largest, off);
      differ += off > 0.01f ? 1 : 0;
    }
  }
  // A pair within rounding of the border between two bins may be counted in either, and changes the
  // descriptors of all its neighbours.
  CHECK(cloud.size() > 3000);
  CHECK(static_cast<double>(differ) < 0.02 * kFpfhSize * static_cast<double>(cloud.size()));
  CHECK(largest < 5);
}

TEST_CASE("ISS keypoints are those of the Point Cloud Library") {
  const PointCloud cloud = scene();
  pcl::ISSKeypoint3D<pcl::PointXYZ, pcl::PointXYZ> detector;
  detector.setInputCloud(pcl_points(cloud));
  detector.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  detector.setSalientRadius(2);
  detector.setNonMaxRadius(1);
  pcl::PointCloud<pcl::PointXYZ> keypoints;
  detector.compute(keypoints);
  const auto& indices = detector.getKeypointsIndices()->indices;
  std::vector<std::uint32_t> theirs(indices.begin(), indices.end());
  std::sort(theirs.begin(), theirs.end());

  IssOptions options;
  options.salient_radius = 2;
  options.suppression_radius = 1;
  CHECK(theirs.size() > 30);
  const std::vector<std::uint32_t> ours = iss_keypoints(cloud, radius_neighbours(cloud, 2), options);
  std::vector<std::uint32_t> differ;
  std::set_symmetric_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                                std::back_inserter(differ));
  // Ratios of eigenvalues at the threshold may be decided either way.
  CHECK(differ.size() * 100 <= theirs.size());
}
#else
TEST_CASE("the Point Cloud Library is not installed") {
  MESSAGE("skipped: FPFH and ISS are not compared with the Point Cloud Library");
}
#endif
