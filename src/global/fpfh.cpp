// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/fpfh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "geometry/angles.hpp"

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

/// The three angles between a point and others, with normals, as bins. The same seen from either point: the
/// frame stands on the one whose normal is nearer to the line between them. Many at once and without a
/// branch, so that the compiler takes several in a step.
class PairBins {
 public:
  std::vector<std::uint32_t> others;
  std::vector<int> f1, f2, f3;

  void compute(const PointCloud& cloud, std::uint32_t point, const AngleBorders& borders) {
    const std::size_t n = others.size();
    for (std::vector<float>* v : {&dx_, &dy_, &dz_, &nx_, &ny_, &nz_}) v->resize(n);
    for (std::vector<int>* v : {&f1, &f2, &f3}) v->resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t b = others[k];
      dx_[k] = cloud.x[b] - cloud.x[point];
      dy_[k] = cloud.y[b] - cloud.y[point];
      dz_[k] = cloud.z[b] - cloud.z[point];
      nx_[k] = cloud.nx[b];
      ny_[k] = cloud.ny[b];
      nz_[k] = cloud.nz[b];
    }
    const Vector here{cloud.nx[point], cloud.ny[point], cloud.nz[point]};
    int *first = f1.data(), *second = f2.data(), *third = f3.data();
    for (std::size_t k = 0; k < n; ++k) {
      const Vector d{dx_[k], dy_[k], dz_[k]}, there{nx_[k], ny_[k], nz_[k]};
      const float length = std::sqrt(dot(d, d));
      const float angle1 = dot(here, d) / length, angle2 = dot(there, d) / length;
      const bool swapped = std::abs(angle1) < std::abs(angle2);
      const Vector n1 = choose(swapped, there, here), n2 = choose(swapped, here, there);
      const Vector line = choose(swapped, {-d.x, -d.y, -d.z}, d);
      Vector v = cross(line, n1);
      const float v_length = std::sqrt(dot(v, v));
      v = {v.x / v_length, v.y / v_length, v.z / v_length};
      // Pairs without a frame get what three zeros give.
      const bool framed = v_length > 0;
      first[k] = borders.bin(framed ? dot(cross(n1, v), n2) : 0.0f, framed ? dot(n1, n2) : 1.0f);
      second[k] = linear_bin(framed ? dot(v, n2) : 0.0f);
      third[k] = linear_bin(framed ? (swapped ? -angle2 : angle1) : 0.0f);
    }
  }

 private:
  std::vector<float> dx_, dy_, dz_, nx_, ny_, nz_;
};

/// The simplified histograms of all points that some keypoint has in its neighbourhood.
class SimpleHistograms {
 public:
  SimpleHistograms(const PointCloud& cloud, const NeighbourLists& neighbours,
                   const std::vector<std::uint32_t>& keypoints)
      : needed_(cloud.size(), 0),
        rows_(Descriptors::Zero(static_cast<Eigen::Index>(cloud.size()), kFpfhSize)) {
    for (std::uint32_t keypoint : keypoints) {
      for (std::uint32_t e = neighbours.begin[keypoint]; e < neighbours.end[keypoint]; ++e)
        needed_[neighbours.index[e]] = 1;
    }
    const AngleBorders borders;
    PairBins pairs;
    for (std::uint32_t a = 0; a < cloud.size(); ++a) {
      pairs.others.clear();
      for (std::uint32_t e = neighbours.begin[a]; e < neighbours.end[a]; ++e) {
        const std::uint32_t b = neighbours.index[e];
        if (b > a && (needed_[a] || needed_[b])) pairs.others.push_back(b);
      }
      pairs.compute(cloud, a, borders);
      for (std::size_t k = 0; k < pairs.others.size(); ++k) {
        count(a, pairs, k);
        count(pairs.others[k], pairs, k);
      }
    }
    for (std::uint32_t a = 0; a < cloud.size(); ++a) {
      if (needed_[a] && neighbours.count(a) > 1)
        rows_.row(a) *= 100.0f / static_cast<float>(neighbours.count(a) - 1);
    }
  }

  const float* row(std::size_t i) const { return rows_.data() + i * kFpfhSize; }

 private:
  void count(std::uint32_t i, const PairBins& pairs, std::size_t k) {
    float* row = rows_.data() + std::size_t{i} * kFpfhSize;
    row[pairs.f1[k]] += 1;
    row[kBins + pairs.f2[k]] += 1;
    row[2 * kBins + pairs.f3[k]] += 1;
  }

  std::vector<std::uint8_t> needed_;
  Descriptors rows_;
};

}  // namespace

Descriptors fpfh(const PointCloud& cloud, const NeighbourLists& neighbours,
                 const std::vector<std::uint32_t>& keypoints) {
  if (!keypoints.empty() && !cloud.has_normals())
    throw std::invalid_argument("fpfh: the cloud has no normals");
  const SimpleHistograms simple(cloud, neighbours, keypoints);
  Descriptors result = Descriptors::Zero(static_cast<Eigen::Index>(keypoints.size()), kFpfhSize);
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    float* row = result.data() + k * kFpfhSize;
    for (std::uint32_t e = neighbours.begin[keypoints[k]]; e < neighbours.end[keypoints[k]]; ++e) {
      if (!(neighbours.squared_distance[e] > 0)) continue;
      const float weight = 1.0f / neighbours.squared_distance[e];
      const float* other = simple.row(neighbours.index[e]);
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
