// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/fpfh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "global/neighbour_lists.hpp"

namespace scanlock {
namespace {

constexpr int kBins = kFpfhSize / 3;
constexpr int kMiddle = kBins / 2;

/// Sines and cosines of the borders between bins of the angle, from the middle bin to either side: with them
/// the bin of an angle is found from its sine and cosine.
struct AngleBorders {
  std::array<float, kMiddle> sine{}, cosine{};
  AngleBorders() {
    for (int m = 0; m < kMiddle; ++m) {
      const double border = kPi * (2 * m + 1) / kBins;
      sine[m] = static_cast<float>(std::sin(border));
      cosine[m] = static_cast<float>(std::cos(border));
    }
  }
  int bin(float s, float c) const {
    int steps = 0;
    for (int m = 0; m < kMiddle; ++m) steps += std::abs(s) * cosine[m] >= c * sine[m];
    return s >= 0 ? kMiddle + steps : kMiddle - steps;
  }
};

/// Of a value in [-1, 1].
int linear_bin(float value) {
  return std::clamp(static_cast<int>(static_cast<float>(kBins) * (value + 1.0f) * 0.5f), 0, kBins - 1);
}

struct PairBins {
  int f1 = kMiddle, f2 = kMiddle, f3 = kMiddle;  // what three zeros give: for pairs without a frame
};

/// The three angles between two points with normals, as bins. The same for (a, b) and (b, a): the frame
/// stands on the point whose normal is nearer to the line between them.
PairBins pair_bins(const PointCloud& cloud, std::size_t a, std::size_t b, const AngleBorders& borders) {
  PairBins bins;
  Eigen::Vector3f d = cloud.point(b) - cloud.point(a);
  const float length = d.norm();
  if (!(length > 0)) return bins;
  Eigen::Vector3f n1 = cloud.normal(a), n2 = cloud.normal(b);
  const float angle1 = n1.dot(d) / length, angle2 = n2.dot(d) / length;
  float f3 = angle1;
  if (std::abs(angle1) < std::abs(angle2)) {
    std::swap(n1, n2);
    d = -d;
    f3 = -angle2;
  }
  Eigen::Vector3f v = d.cross(n1);
  const float v_length = v.norm();
  if (!(v_length > 0)) return bins;
  v /= v_length;
  bins.f1 = borders.bin(n1.cross(v).dot(n2), n1.dot(n2));
  bins.f2 = linear_bin(v.dot(n2));
  bins.f3 = linear_bin(f3);
  return bins;
}

/// The simplified histograms of all points that some keypoint has in its neighbourhood.
class SimpleHistograms {
 public:
  SimpleHistograms(const PointCloud& cloud, NeighbourFinder& finder,
                   const std::vector<std::uint32_t>& keypoints)
      : row_(cloud.size(), kNone) {
    number_rows(finder, keypoints);
    const AngleBorders borders;
    std::vector<std::size_t> neighbours(static_cast<std::size_t>(rows_.rows()), 0);
    for (std::uint32_t a : finder.order()) {
      if (row_[a] == kNone) continue;
      const NeighbourFinder::Neighbours& near = finder.about(a);
      neighbours[row_[a]] = near.count();
      for (std::uint32_t b : near.index) {
        const bool needed = row_[b] != kNone;
        if (b == a || (needed && b < a)) continue;  // pairs count for both, once
        const PairBins bins = pair_bins(cloud, std::min(a, b), std::max(a, b), borders);
        count(row_[a], bins);
        if (needed) count(row_[b], bins);
      }
    }
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      if (neighbours[k] > 1)
        rows_.row(static_cast<Eigen::Index>(k)) *= 100.0f / static_cast<float>(neighbours[k] - 1);
    }
  }

  /// Of a point near a keypoint.
  const float* of(std::uint32_t i) const { return rows_.data() + std::size_t{row_[i]} * kFpfhSize; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  void number_rows(NeighbourFinder& finder, const std::vector<std::uint32_t>& keypoints) {
    std::uint32_t rows = 0;
    for (std::uint32_t keypoint : keypoints) {
      for (std::uint32_t i : finder.about(keypoint).index) {
        if (row_[i] == kNone) row_[i] = rows++;
      }
    }
    rows_ = Descriptors::Zero(static_cast<Eigen::Index>(rows), kFpfhSize);
  }

  void count(std::uint32_t number, const PairBins& bins) {
    float* row = rows_.data() + std::size_t{number} * kFpfhSize;
    row[bins.f1] += 1;
    row[kBins + bins.f2] += 1;
    row[2 * kBins + bins.f3] += 1;
  }

  std::vector<std::uint32_t> row_;  // of each point
  Descriptors rows_;
};

}  // namespace

Descriptors fpfh(const PointCloud& cloud, float radius, const std::vector<std::uint32_t>& keypoints) {
  if (!keypoints.empty() && !cloud.has_normals())
    throw std::invalid_argument("fpfh: the cloud has no normals");
  NeighbourFinder finder(cloud, radius);
  const SimpleHistograms simple(cloud, finder, keypoints);
  Descriptors result = Descriptors::Zero(static_cast<Eigen::Index>(keypoints.size()), kFpfhSize);
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    float* row = result.data() + k * kFpfhSize;
    const NeighbourFinder::Neighbours& near = finder.about(keypoints[k]);
    for (std::size_t e = 0; e < near.count(); ++e) {
      if (!(near.squared_distance[e] > 0)) continue;
      const float weight = 1.0f / near.squared_distance[e];
      const float* other = simple.of(near.index[e]);
      for (int b = 0; b < kFpfhSize; ++b) row[b] += weight * other[b];
    }
    for (int part = 0; part < 3; ++part) {
      float sum = 0;
      for (int b = 0; b < kBins; ++b) sum += row[part * kBins + b];
      for (int b = 0; b < kBins && sum > 0; ++b) row[part * kBins + b] *= 100.0f / sum;
    }
  }
  return result;
}

}  // namespace scanlock
