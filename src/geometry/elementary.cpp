// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/elementary.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/double_bits.hpp"

namespace scanlock {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAddsNothing = 0x1p-54;  // for |x| below it, 1 + x rounds to 1

// Every polynomial in this file is minimax on its interval (Remez's exchange in 60 digits, then rounded to
// double), and is evaluated in an order in which the processor can compute several sums in parallel.

// ln 2 as the sum of two parts: the product of the first part with an exponent (11 bits) is exact. 1 / ln 2
// likewise.
constexpr double kLn2 = 0x1.62e42fefa2p-1, kLn2Rest = 0x1.9ef35793c7673p-41;
constexpr double kPerLn2 = 0x1.71547652b82fep+0;
constexpr double kPerLn2Upper = 0x1.715476p+0, kPerLn2Rest = 0x1.4ae0bf85ddf44p-26;

// ---- exponentials: e^x = 2^k e^r with |r| <= ln(2) / 2 -------------------------------------------------

/// e^(r + rest) - 1 = r + tail.
struct Exponential {
  double r, tail;
};

/// |r| <= 0.347, |rest| below the last place of r. The polynomial is the minimax one of (e^r - 1 - r - r^2/2)
/// / r^3; relative error of e^r - 1: 2^-60.
Exponential exponential(double r, double rest) {
  const double z = r * r, z2 = z * z;
  const double a = 0x1.555555555555ap-3 + 0x1.5555555555559p-5 * r;
  const double b = 0x1.111111110f17bp-7 + 0x1.6c16c16c145d5p-10 * r;
  const double c = 0x1.a01a01b1c37a7p-13 + 0x1.a01a01b0bbd8ap-16 * r;
  const double d = 0x1.71ddf3faf66e7p-19 + 0x1.27e4c526cf58dp-22 * r;
  const double e = 0x1.af65d4817bd91p-26 + 0x1.1f966d830c915p-29 * r;
  const double p = (a + z * b) + z2 * ((c + z * d) + z2 * e);
  return {r, z * (0.5 + r * p) + rest};
}

/// exponential() of x - k ln 2, where k is the integer nearest to x / ln 2.
Exponential exponential_beyond(double x, double k) {
  const double upper = x - k * kLn2, lower = k * kLn2Rest;
  const double r = upper - lower;
  return exponential(r, (upper - r) - lower);
}

/// y 2^k for y in [0.7, 1.5] and k in [-1100, 1024].
double scaled(double y, double k) {
  if (std::abs(k) < 1022) return double_of(bits_of(y) + (bits_of(k + kRounder) << 52));
  const double half = nearest_integer(0.5 * k);  // two steps: 2^k may not be a double, or y 2^k subnormal
  return y * power_of_two(half) * power_of_two(k - half);
}

// ---- logarithms: log x = k ln 2 + log(1 + f), sqrt(1/2) <= 1 + f < sqrt(2) ------------------------------

struct Split {
  double k, f;
};

/// x > 0 and finite.
Split split(double x) {
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd, kOne = std::uint64_t{1} << 52;
  const bool subnormal = x < std::numeric_limits<double>::min();
  const std::uint64_t bits = bits_of(subnormal ? x * 0x1p54 : x);
  const std::int64_t k = static_cast<std::int64_t>((bits - kRootHalf + 1024 * kOne) / kOne) - 1024;
  const double f = double_of(bits - static_cast<std::uint64_t>(k) * kOne) - 1.0;
  return {static_cast<double>(subnormal ? k - 54 : k), f};
}

/// f - log(1 + f). With s = f / (2 + f), log(1 + f) = log((1 + s) / (1 - s)) = 2 s + s^3 R(s^2), and 2 s is
/// f - f^2/2 + s f^2/2; the polynomial is the minimax one of R. Error: 2^-59 of log(1 + f), plus the rounding
/// of f - log(1 + f), which is at most a fifth of log(1 + f).
double below_linear(double f) {
  const double s = f / (2.0 + f), z = s * s, z2 = z * z, half = 0.5 * f * f;
  const double a = 0x1.5555555555592p-1 + 0x1.999999997fd36p-2 * z;
  const double b = 0x1.24924941f8dfdp-2 + 0x1.c71c5202a5f29p-3 * z;
  const double c = 0x1.7466405e936d9p-3 + 0x1.39a192f2c30e5p-3 * z;
  return half - s * (half + z * ((a + z2 * b) + z2 * z2 * (c + z2 * 0x1.2f07081a33cc7p-3)));
}

/// k ln 2 + log(1 + f) + more, where |more| is much smaller than the other terms.
double logarithm(double k, double f, double more) {
  const double below = below_linear(f);
  if (k == 0) return f - (below - more);
  const double first = k * kLn2, sum = first + f;
  const double lost = (first - sum) + f;
  return sum + (lost - (below - (k * kLn2Rest + more)));
}

/// The logarithm of an x outside of (0, infinity): -infinity at 0, infinity at infinity, else NaN.
double logarithm_outside(double x) {
  return x == 0 ? -kInfinity : x > 0 ? x : kNan;
}

bool has_logarithm(double x) {
  return x > 0 && x < kInfinity;
}

}  // namespace

double exp(double x) {
  const double bounded = x > 710.0 ? 710.0 : x < -746.0 ? -746.0 : x;  // the result is infinity, or 0, there
  const double k = nearest_integer(bounded * kPerLn2);
  const Exponential e = exponential_beyond(bounded, k);
  return scaled(1.0 + (e.r + e.tail), k);
}

double expm1(double x) {
  if (std::abs(x) < kAddsNothing) return x;  // keeps the sign of -0
  if (x < -40.0) return -1.0;
  const double bounded = x > 710.0 ? 710.0 : x;
  const double k = nearest_integer(bounded * kPerLn2);
  const Exponential e = exponential_beyond(bounded, k);
  if (k == 0) return e.r + e.tail;
  if (k > 60) return scaled(1.0 + (e.r + e.tail), k);
  // 2^k (1 + r + tail) - 1; `lost` is the rounding error of the first sum.
  const double scale = power_of_two(k), one_less = k <= 53 ? scale - 1.0 : scale;
  const double sum = one_less + scale * e.r;
  const double lost = (one_less - sum) + scale * e.r;
  return sum + ((k <= 53 ? lost : lost - 1.0) + scale * e.tail);
}

double exp2(double x) {
  const double bounded = x > 1025.0 ? 1025.0 : x < -1077.0 ? -1077.0 : x;
  const double k = nearest_integer(bounded), r = bounded - k;
  // r ln 2 = product + rest, where the product is exact.
  const double upper = upper_half(r), product = upper * upper_half(kLn2);
  const double rest = upper * ((kLn2 - upper_half(kLn2)) + kLn2Rest) + (r - upper) * (kLn2 + kLn2Rest);
  const double sum = product + rest;
  const Exponential e = exponential(sum, (product - sum) + rest);
  return scaled(1.0 + (e.r + e.tail), k);
}

double log(double x) {
  if (!has_logarithm(x)) return logarithm_outside(x);
  const auto [k, f] = split(x);
  return logarithm(k, f, 0.0);
}

double log1p(double x) {
  if (std::abs(x) < kAddsNothing) return x;
  const double u = 1.0 + x;
  if (!has_logarithm(u)) return logarithm_outside(u);
  const auto [k, f] = split(u);
  if (k == 0) return logarithm(0, x, 0.0);
  const double lost = x > 1.0 ? 1.0 - (u - x) : x - (u - 1.0);
  return logarithm(k, f, lost / u);
}

double log2(double x) {
  if (!has_logarithm(x)) return logarithm_outside(x);
  const auto [k, f] = split(x);
  const double upper = upper_half(f), product = upper * kPerLn2Upper;  // exact
  const double rest = (f - upper) * kPerLn2Upper + f * kPerLn2Rest - below_linear(f) * kPerLn2;
  const double sum = k + product;
  return sum + (((k - sum) + product) + rest);
}

double hypot(double x, double y) {
  if (std::isinf(x) || std::isinf(y)) return kInfinity;
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const double a = std::max(std::abs(x), std::abs(y)), b = std::min(std::abs(x), std::abs(y));
  if (a == 0) return 0;
  const double scale = a > 0x1p500 ? 0x1p-600 : a < 0x1p-400 ? 0x1p600 : 1.0;
  const double p = a * scale, q = b * scale;
  const double root = std::sqrt(p * p + q * q);
  // The difference p^2 + q^2 - root^2, with each square as upper^2 + (whole - upper) (whole + upper).
  const double pu = upper_half(p), qu = upper_half(q), ru = upper_half(root);
  const double squares = (pu * pu - ru * ru) + qu * qu;
  const double rest = (p - pu) * (p + pu) - (root - ru) * (root + ru) + (q - qu) * (q + qu);
  return (root + (squares + rest) / (root + root)) / scale;
}

}  // namespace scanlock
