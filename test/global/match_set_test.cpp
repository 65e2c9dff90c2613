// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the parts of the match set against their definitions, computed directly.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "geometry/angles.hpp"
#include "geometry/voxel_grid.hpp"
#include "global/cloud_normals.hpp"
#include "global/descriptor_matching.hpp"
#include "global/fpfh.hpp"
#include "global/ground_height.hpp"
#include "global/iss_keypoints.hpp"
#include "global/neighbour_lists.hpp"
#include "scenes.hpp"

using namespace scanlock;

namespace {

PointCloud small_scene() {
  const PointCloud cloud = yard(3, 5);
  return select(cloud, thin_by_voxel(cloud, 1.2f));
}

int bin(double value, double low, double high) {
  return std::clamp(static_cast<int>(std::floor(11 * (value - low) / (high - low))), 0, 10);
}

/// The histograms of one point, by the text of Rusu et al.
std::vector<double> simple_histogram(const PointCloud& cloud, std::size_t i, double radius) {
  std::vector<double> h(33, 0.0);
  int pairs = 0;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    Eigen::Vector3d d = (cloud.point(j) - cloud.point(i)).cast<double>();
    if (j == i || d.norm() > radius) continue;
    ++pairs;
    Eigen::Vector3d n1 = cloud.normal(i).cast<double>(), n2 = cloud.normal(j).cast<double>();
    double f3 = n1.dot(d.normalized());
    if (std::abs(f3) < std::abs(n2.dot(d.normalized()))) {
      f3 = -n2.dot(d.normalized());
      std::swap(n1, n2);
      d = -d;
    }
    const Eigen::Vector3d v = d.cross(n1).normalized(), w = n1.cross(v);
    h[bin(std::atan2(w.dot(n2), n1.dot(n2)), -kPi, kPi)] += 1;
    h[11 + bin(v.dot(n2), -1, 1)] += 1;
    h[22 + bin(f3, -1, 1)] += 1;
  }
  for (double& value : h) value *= 100.0 / std::max(pairs, 1);
  return h;
}

}  // namespace

TEST_CASE("radius neighbours are those of a search through all points") {
  PointCloud cloud = small_scene();
  cloud.x[7] = std::numeric_limits<float>::quiet_NaN();
  const float radius = 3;
  const NeighbourLists lists = radius_neighbours(cloud, radius);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t j = 0; j < cloud.size(); ++j) {
      if ((cloud.point(i) - cloud.point(j)).squaredNorm() <= radius * radius) expected.push_back(j);
    }
    const std::vector<std::uint32_t> found(lists.index.begin() + lists.begin[i],
                                           lists.index.begin() + lists.begin[i + 1]);
    CHECK(found == expected);
  }
  CHECK(lists.count(7) == 0);
  NeighbourFinder finder(cloud, radius);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    CHECK(finder.has_more_than(20, i) == (lists.count(i) > 20));
    CHECK(finder.about(i).count() == lists.count(i));
  }
  CHECK_THROWS_AS(radius_neighbours(cloud, 0), std::invalid_argument);
}

TEST_CASE("normals of a wall and the ground point to the sensor") {
  PointCloud cloud;
  for (int a = 0; a < 20; ++a) {
    for (int b = 0; b < 20; ++b) {
      cloud.push_back(5, 0.2f * static_cast<float>(a), 0.2f * static_cast<float>(b));
      cloud.push_back(0.2f * static_cast<float>(a), 0.2f * static_cast<float>(b) + 10, -2);
    }
  }
  cloud.push_back(100, 100, 100);
  add_normals(&cloud, 0.7f);
  for (std::size_t i = 0; i + 1 < cloud.size(); ++i) {
    const Eigen::Vector3f expected = i % 2 == 0 ? Eigen::Vector3f(-1, 0, 0) : Eigen::Vector3f(0, 0, 1);
    CHECK((cloud.normal(i) - expected).norm() < 1e-4f);
  }
  CHECK(cloud.normal(cloud.size() - 1).norm() == 0);
}

TEST_CASE("FPFH follows its definition") {
  PointCloud cloud = small_scene();
  const float radius = 4;
  add_normals(&cloud, 3);
  std::vector<std::uint32_t> keypoints;
  for (std::uint32_t i = 5; i < cloud.size(); i += 97) keypoints.push_back(i);
  const Descriptors found = fpfh(cloud, radius, keypoints);
  double far_off = 0;
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    std::vector<double> expected(33, 0.0);
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const double d = static_cast<double>((cloud.point(j) - cloud.point(keypoints[k])).norm());
      if (j == keypoints[k] || d > static_cast<double>(radius)) continue;
      const std::vector<double> simple = simple_histogram(cloud, j, static_cast<double>(radius));
      for (int b = 0; b < 33; ++b) expected[b] += simple[b] / (d * d);
    }
    for (int part = 0; part < 3; ++part) {
      double sum = 0;
      for (int b = 0; b < 11; ++b) sum += expected[11 * part + b];
      for (int b = 0; b < 11 && sum > 0; ++b) {
        const double off = std::abs(found(static_cast<Eigen::Index>(k), 11 * part + b) -
                                    100 * expected[11 * part + b] / sum);
        far_off += off > 0.01 ? 1 : 0;  // a pair on the border between two bins may be counted in either
      }
    }
  }
  CHECK(keypoints.size() > 5);
  CHECK(far_off <= 0.02 * 33 * static_cast<double>(keypoints.size()));
}

TEST_CASE("ISS keypoints are the most salient points of their neighbourhood") {
  const PointCloud cloud = small_scene();
  IssOptions options;
  options.salient_radius = 4;
  options.suppression_radius = 2;
  std::vector<double> salient(cloud.size(), 0.0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const Eigen::Vector3d d = (cloud.point(j) - cloud.point(i)).cast<double>();
      if (d.norm() <= 4) scatter += d * d.transpose();
    }
    const Eigen::Vector3d l = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
    if (l[1] < 0.975 * l[2] && l[0] < 0.975 * l[1] && l[0] > 1e-9 * l[2]) salient[i] = l[0];
  }
  const auto found = iss_keypoints(cloud, radius_neighbours(cloud, 4), options);
  CHECK(found.size() > 10);
  for (std::uint32_t i : found) {
    int near = 0;
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      if ((cloud.point(j) - cloud.point(i)).norm() > 2) continue;
      ++near;
      CHECK(salient[j] <= salient[i] * (1 + 1e-6));
    }
    CHECK(near >= options.least_neighbours);
  }
}

TEST_CASE("mutual nearest descriptors are those of a search through all pairs") {
  std::mt19937 rng(1);
  const auto noise = [&](Eigen::Index rows) {
    Descriptors d(rows, 33);
    for (Eigen::Index i = 0; i < d.size(); ++i) d.data()[i] = static_cast<float>(rng() % 1000) * 0.1f;
    return d;
  };
  const Descriptors a = noise(150), b = noise(90);
  const auto rank = [](const Descriptors& from, Eigen::Index i, const Descriptors& to, Eigen::Index j) {
    int nearer = 0;
    const double mine = (from.row(i) - to.row(j)).cast<double>().squaredNorm();
    for (Eigen::Index k = 0; k < to.rows(); ++k)
      nearer += (from.row(i) - to.row(k)).cast<double>().squaredNorm() < mine;
    return nearer;
  };
  std::vector<std::array<int, 3>> expected, found;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      const int most = 1 + std::max(rank(a, i, b, j), rank(b, j, a, i));
      if (most <= 7) expected.push_back({static_cast<int>(i), static_cast<int>(j), most});
    }
  }
  CHECK(expected.size() > 20);
  for (const MutualPair& pair : mutual_nearest(a, b, 7))
    found.push_back({static_cast<int>(pair.a), static_cast<int>(pair.b), pair.rank});
  CHECK(found == expected);
  CHECK(mutual_nearest(a, b, 0).empty());
  CHECK(mutual_nearest(a, Descriptors(0, 33), 7).empty());
  CHECK_THROWS_AS(mutual_nearest(a, Descriptors(3, 32), 7), std::invalid_argument);
}

TEST_CASE("heights are measured from the lowest point nearby") {
  PointCloud cloud;
  for (int x = 0; x < 50; ++x)
    cloud.push_back(static_cast<float>(x), 0, 7 + 0.1f * static_cast<float>(x));  // a ramp
  cloud.push_back(20, 0, 12);
  const std::vector<float> heights = heights_above_ground(cloud, 2);
  CHECK(heights[50] > 2.9f);
  CHECK(heights[50] < 3.5f);
  for (std::size_t i = 0; i < 50; ++i) CHECK(heights[i] < 0.45f);
}
