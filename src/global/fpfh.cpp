// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/fpfh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "global/neighbour_lists.hpp"

namespace scanlock {
namespace {

constexpr int kBins = kFpfhSize / 3;
constexpr int kMiddle = kBins / 2;

/// Sines and cosines of the borders between the bins of the angle, from the middle bin to either side, by
/// which the bin of an angle is found from its sine and cosine.
struct AngleBorders {
  std::array<float, kMiddle> sine{}, cosine{};
  AngleBorders() {
    for (int m = 0; m < kMiddle; ++m) {
      const double border = kPi * (2 * m + 1) / kBins;
      sine[m] = static_cast<float>(sin(border));
      cosine[m] = static_cast<float>(cos(border));
    }
  }
  int bin(float s, float c) const {
    int steps = 0;
    for (int m = 0; m < kMiddle; ++m) steps += std::abs(s) * cosine[m] >= c * sine[m];
    return s >= 0 ? kMiddle + steps : kMiddle - steps;
  }
};

/// The bin of a value in [-1, 1].
int linear_bin(float value) {
  const int bin = static_cast<int>(static_cast<float>(kBins) * (value + 1.0f) * 0.5f);
  return bin < 0 ? 0 : bin < kBins ? bin : kBins - 1;
}

struct Vector {
  float x, y, z;
};
float dot(const Vector& a, const Vector& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector choose(bool first, const Vector& a, const Vector& b) {
  return {first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z};
}

/// The bins of the three angles between a point and each of several others, all with normals. They are the
/// same if the two points of a pair are exchanged: the frame is at the point whose normal is nearer to the
/// line between the two, or which has the lower index. Many pairs at once and without a branch, so that the
/// compiler can vectorise the loop.
class PairBins {
 public:
  std::vector<std::uint32_t> others;
  std::vector<int> f1, f2, f3;

  void compute(const PointCloud& cloud, std::uint32_t point, const AngleBorders& borders) {
    const std::size_t n = others.size();
    for (std::vector<float>* v : {&sign_, &dx_, &dy_, &dz_, &nx_, &ny_, &nz_}) v->resize(n);
    for (std::vector<int>* v : {&f1, &f2, &f3}) v->resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t b = others[k];
      sign_[k] = point < b ? 1.0f : -1.0f;
      dx_[k] = sign_[k] * (cloud.x[b] - cloud.x[point]);
      dy_[k] = sign_[k] * (cloud.y[b] - cloud.y[point]);
      dz_[k] = sign_[k] * (cloud.z[b] - cloud.z[point]);
      nx_[k] = cloud.nx[b];
      ny_[k] = cloud.ny[b];
      nz_[k] = cloud.nz[b];
    }
    const Vector own{cloud.nx[point], cloud.ny[point], cloud.nz[point]};
    int *first = f1.data(), *second = f2.data(), *third = f3.data();
    for (std::size_t k = 0; k < n; ++k) {
      const Vector d{dx_[k], dy_[k], dz_[k]}, other{nx_[k], ny_[k], nz_[k]};
      const Vector here = choose(sign_[k] > 0, own, other), there = choose(sign_[k] > 0, other, own);
      const float length = std::sqrt(dot(d, d));
      const float angle1 = dot(here, d) / length, angle2 = dot(there, d) / length;
      const bool swapped = std::abs(angle1) < std::abs(angle2);
      const Vector n1 = choose(swapped, there, here), n2 = choose(swapped, here, there);
      const Vector line = choose(swapped, {-d.x, -d.y, -d.z}, d);
      Vector v = cross(line, n1);
      const float v_length = std::sqrt(dot(v, v));
      v = {v.x / v_length, v.y / v_length, v.z / v_length};
      // Pairs without a frame get the bins of three zeros.
      const bool framed = v_length > 0;
      first[k] = borders.bin(framed ? dot(cross(n1, v), n2) : 0.0f, framed ? dot(n1, n2) : 1.0f);
      second[k] = linear_bin(framed ? dot(v, n2) : 0.0f);
      third[k] = linear_bin(framed ? (swapped ? -angle2 : angle1) : 0.0f);
    }
  }

 private:
  std::vector<float> sign_, dx_, dy_, dz_, nx_, ny_, nz_;
};

/// The simplified histograms (SPFH) of all points in the neighbourhood of any keypoint.
class SimpleHistograms {
 public:
  SimpleHistograms(const PointCloud& cloud, NeighbourFinder& finder,
                   const std::vector<std::uint32_t>& keypoints)
      : row_(cloud.size(), kNone) {
    number_rows(finder, keypoints);
    const AngleBorders borders;
    PairBins pairs;
    std::vector<std::size_t> neighbours(static_cast<std::size_t>(rows_.rows()), 0);
    for (std::uint32_t a : finder.order()) {
      if (row_[a] == kNone) continue;
      const NeighbourFinder::Neighbours& near = finder.about(a);
      neighbours[row_[a]] = near.count();
      pairs.others.clear();
      for (std::uint32_t b : near.index) {
        const bool counted = row_[b] != kNone && b < a;  // each pair is counted once, for both points
        if (b != a && !counted) pairs.others.push_back(b);
      }
      pairs.compute(cloud, a, borders);
      for (std::size_t k = 0; k < pairs.others.size(); ++k) {
        const std::uint32_t b = pairs.others[k];
        count(row_[a], pairs, k);
        if (row_[b] != kNone) count(row_[b], pairs, k);
      }
    }
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      if (neighbours[k] > 1)
        rows_.row(static_cast<Eigen::Index>(k)) *= 100.0f / static_cast<float>(neighbours[k] - 1);
    }
  }

  /// The histograms of point i, which has to be near a keypoint.
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

  void count(std::uint32_t number, const PairBins& pairs, std::size_t k) {
    float* row = rows_.data() + std::size_t{number} * kFpfhSize;
    row[pairs.f1[k]] += 1;
    row[kBins + pairs.f2[k]] += 1;
    row[2 * kBins + pairs.f3[k]] += 1;
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
