// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>

#include "geometry/elementary.hpp"

namespace scanlock {

/// A bijection on 64 bits whose output bits all depend on all input bits.
inline std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A number in [0, 1) from 64 random bits.
inline double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Random numbers that are the same on every machine, unlike those of the distributions of <random>. Do not
/// draw twice in the arguments of one call, nor in both operands of an operator: the order of evaluation
/// depends on the compiler. Named variables and braced lists are evaluated in the order in which they are
/// written.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t substream = 0)
      : state_(mix_bits(seed + kStep * mix_bits(stream + kStep * mix_bits(substream + kStep)))) {}

  std::uint64_t bits() { return mix_bits(state_ += kStep); }
  double uniform() { return unit_interval(bits()); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  bool chance(double probability) { return uniform() < probability; }
  /// A whole number from low to high, both included.
  int integer(int low, int high) { return low + static_cast<int>(uniform() * (high - low + 1)); }
  double gaussian() {
    const double radius = std::sqrt(-2.0 * log(1.0 - uniform()));
    return radius * cos(6.283185307179586 * uniform());
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ull;
  std::uint64_t state_;
};

}  // namespace scanlock
