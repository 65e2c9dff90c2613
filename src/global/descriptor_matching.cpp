// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/descriptor_matching.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace scanlock {
namespace {

constexpr Eigen::Index kBlock = 64;  // rows: a block of distances stays in cache

/// The nearest rows of one descriptor; the result does not depend on the order of the calls of offer().
class Nearest {
 public:
  struct Entry {
    float distance;
    std::uint32_t row;
    bool operator<(const Entry& other) const {
      return distance != other.distance ? distance < other.distance : row < other.row;
    }
  };

  void offer(float distance, std::uint32_t row, std::size_t capacity) {
    const Entry entry{distance, row};
    if (entries_.size() == capacity) {
      if (!(entry < entries_.back())) return;
      entries_.pop_back();
    }
    entries_.insert(std::upper_bound(entries_.begin(), entries_.end(), entry), entry);
    if (entries_.size() == capacity) bound_ = entries_.back().distance;
  }
  float bound() const { return bound_; }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;  // nearest first
  float bound_ = std::numeric_limits<float>::infinity();
};

/// Number of columns of a product that are summed at once, in registers.
constexpr Eigen::Index kStrip = 16;
using Strip = Eigen::Array<float, kStrip, 1>;

/// Sets the first `rows` rows of `product` to a b, where `a` points to the first of `rows` rows, and the
/// number of columns of b is a multiple of kStrip. Each element is summed in the order of the columns of a.
/// The order of Eigen's product depends on the processor, with fused additions on arm64, so that near ties
/// between descriptors would be decided differently there.
void multiply(const float* a, Eigen::Index rows, const Descriptors& b, Descriptors* product) {
  const Eigen::Index depth = b.rows();
  for (Eigen::Index column = 0; column < b.cols(); column += kStrip) {
    for (Eigen::Index row = 0; row < rows; row += 2) {
      const Eigen::Index next = std::min(row + 1, rows - 1);
      Strip sum = Strip::Zero(), next_sum = Strip::Zero();
      for (Eigen::Index k = 0; k < depth; ++k) {
        const Eigen::Map<const Strip> factors(b.data() + k * b.cols() + column);
        sum += a[row * depth + k] * factors;
        next_sum += a[next * depth + k] * factors;
      }
      Eigen::Map<Strip>(product->data() + row * product->cols() + column) = sum;
      Eigen::Map<Strip>(product->data() + next * product->cols() + column) = next_sum;
    }
  }
}

}  // namespace

std::vector<MutualPair> mutual_nearest(const Descriptors& a, const Descriptors& b, int lambda) {
  if (a.cols() != b.cols()) throw std::invalid_argument("mutual_nearest: descriptors of different lengths");
  const std::size_t capacity = static_cast<std::size_t>(std::max(lambda, 0));
  std::vector<MutualPair> pairs;
  if (capacity == 0 || a.rows() == 0 || b.rows() == 0) return pairs;
  std::vector<Nearest> of_a(static_cast<std::size_t>(a.rows())), of_b(static_cast<std::size_t>(b.rows()));
  // Relative to a common mean, which reduces the cancellation in |a|^2 + |b|^2 - 2 a.b.
  const Eigen::RowVectorXf mean = b.colwise().mean();
  const Descriptors centred_a = a.rowwise() - mean;
  const Eigen::MatrixXf columns_b = (b.rowwise() - mean).transpose();
  const Eigen::Index columns = (b.rows() + kStrip - 1) / kStrip * kStrip;
  Descriptors strips_b = Descriptors::Zero(b.cols(), columns);
  strips_b.leftCols(b.rows()) = columns_b;
  Eigen::RowVectorXf squares_b = Eigen::RowVectorXf::Zero(columns);
  squares_b.head(b.rows()) = columns_b.colwise().squaredNorm();
  std::vector<float> bounds_b(static_cast<std::size_t>(b.rows()), std::numeric_limits<float>::infinity());
  Descriptors distances(kBlock, columns);
  for (Eigen::Index first = 0; first < a.rows(); first += kBlock) {
    const Eigen::Index rows = std::min(kBlock, a.rows() - first);
    multiply(centred_a.data() + first * centred_a.cols(), rows, strips_b, &distances);
    auto block = distances.topRows(rows);
    block *= -2.0f;
    block.rowwise() += squares_b;
    block.colwise() += centred_a.middleRows(first, rows).rowwise().squaredNorm();
    for (Eigen::Index r = 0; r < rows; ++r) {
      const std::uint32_t i = static_cast<std::uint32_t>(first + r);
      const float* row = distances.data() + r * distances.cols();
      Nearest& mine = of_a[i];
      for (std::uint32_t j = 0; j < of_b.size(); ++j) {
        if (row[j] <= mine.bound()) mine.offer(row[j], j, capacity);
        if (row[j] <= bounds_b[j]) {
          of_b[j].offer(row[j], i, capacity);
          bounds_b[j] = of_b[j].bound();
        }
      }
    }
  }
  for (std::uint32_t i = 0; i < of_a.size(); ++i) {
    int rank = 0;
    for (const Nearest::Entry& mine : of_a[i].entries()) {
      ++rank;
      int other_rank = 0;
      for (const Nearest::Entry& other : of_b[mine.row].entries()) {
        ++other_rank;
        if (other.row == i) pairs.push_back({i, mine.row, std::max(rank, other_rank)});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const MutualPair& left, const MutualPair& right) {
    return left.a != right.a ? left.a < right.a : left.b < right.b;
  });
  return pairs;
}

}  // namespace scanlock
