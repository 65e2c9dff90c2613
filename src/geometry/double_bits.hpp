// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cfloat>
#include <cstdint>
#include <cstring>
#include <limits>

namespace scanlock {

static_assert(FLT_EVAL_METHOD == 0, "doubles must be rounded to double after every operation");
static_assert(std::numeric_limits<double>::is_iec559, "doubles must be those of IEEE 754");

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline std::uint64_t bits_of(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

inline double double_of(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

/// x without the last 27 of its 53 binary digits: the product of two numbers of this form is exact.
inline double upper_half(double x) {
  return double_of(bits_of(x) & ~std::uint64_t{(1u << 27) - 1});
}

/// The sum x + kRounder, for |x| < 2^51, is rounded to an integer: the last bits of the sum are those of the
/// integer nearest to x.
inline constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52

inline double nearest_integer(double x) {
  return (x + kRounder) - kRounder;
}

/// 2^k for an integer k in [-1022, 1023].
inline double power_of_two(double k) {
  return double_of(bits_of(k + (kRounder + 1023)) << 52);
}

}  // namespace scanlock
