// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/double_bits.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kSquareAddsNothing = 0x1p-27;  // for |x| below it, 1 - x^2 / 2 rounds to 1
constexpr double kHalfPi = 0x1.921fb54442d18p+0, kHalfPiRest = 0x1.1a62633145c07p-54;

// ---- sine and cosine: x = quadrant pi/2 + r + rest with |r| <= pi/4 ---------------------------------------

struct Turn {
  double r, rest;
  std::uint64_t quadrant;  ///< modulo 4
};

/// Adds term to *sum, and the rounding error of that addition to *rest. For numbers of any size.
void add(double term, double* sum, double* rest) {
  const double before = *sum, after = before + term, added = after - before;
  *rest += (before - (after - added)) + (term - added);
  *sum = after;
}

Turn turn_of(double x) {
  constexpr double kPerHalfPi = 0x1.45f306dc9c883p-1;
  // pi / 2 as a sum of parts of 33 bits, whose products with a quadrant (20 bits) are exact. The error of the
  // sum is 2^-156.
  constexpr double kPart[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104};
  if (std::abs(x) <= 0.5 * kHalfPi) return {x, 0.0, 0};
  if (std::abs(x) > 0x1p20) x = std::remainder(x, 2 * kPi);  // exact by IEEE 754
  const double shifted = x * kPerHalfPi + kRounder, k = shifted - kRounder;
  double sum = x - k * kPart[0], rest = 0.0;
  add(-k * kPart[1], &sum, &rest);
  add(-k * kPart[2], &sum, &rest);
  rest -= k * kPart[3];
  const double r = sum + rest;
  return {r, (sum - r) + rest, bits_of(shifted) & 3};
}

// Minimax polynomials of sine and cosine; relative errors 2^-56 and 2^-59, including the rounding of the
// coefficients.
double sine(double r, double rest) {
  const double z = r * r, z2 = z * z;
  const double a = -0x1.5555555555548p-3 + 0x1.111111110f7cap-7 * z;
  const double b = -0x1.a01a019bfd1a3p-13 + 0x1.71de35671477fp-19 * z;
  const double c = -0x1.ae5e59f766782p-26 + 0x1.5d8fa3adebad7p-33 * z;
  return r + (z * r * (a + z2 * (b + z2 * c)) + rest * (1.0 - 0.5 * z));
}

double cosine(double r, double rest) {
  const double z = r * r, z2 = z * z;
  const double a = 0x1.555555555554bp-5 - 0x1.6c16c16c14f8ap-10 * z;
  const double b = 0x1.a01a019c8391ap-16 - 0x1.27e4f7ea38124p-22 * z;
  const double c = 0x1.1ee9d752e4348p-29 - 0x1.8fa46618aca56p-37 * z;
  const double half = 0.5 * z, most = 1.0 - half;
  return most + (((1.0 - most) - half) + (z2 * (a + z2 * (b + z2 * c)) - r * rest));
}

// ---- inverse functions ------------------------------------------------------------------------------------

/// (asin(x) - x) / x for x^2 = z <= 1/4; minimax, relative error of asin 2^-59.
double arcsine_excess(double z) {
  const double z2 = z * z, z4 = z2 * z2;
  const double a = 0x1.5555555555577p-3 + 0x1.333333332e103p-4 * z;
  const double b = 0x1.6db6db721419ap-5 + 0x1.f1c71a946b8ddp-6 * z;
  const double c = 0x1.6e8bdeed1657ap-6 + 0x1.1c49ef9176acdp-6 * z;
  const double d = 0x1.ca1f9e879b3b6p-7 + 0x1.75850a8d464a2p-7 * z;
  const double e = 0x1.613f1a81171dbp-7 + 0x1.e5d1cef5bdfafp-9 * z;
  const double f = 0x1.63a690e782df0p-6 - 0x1.580ae58831ee0p-6 * z;
  return z * ((a + z2 * b) + z4 * ((c + z2 * d) + z4 * ((e + z2 * f) + z4 * 0x1.0b4aaf889b3eap-5)));
}

struct Sum {
  double most, rest;
};

/// acos(x) / 2 = asin(sqrt((1 - x) / 2)) for x in [1/2, 1].
Sum half_arccosine(double x) {
  const double z = 0.5 * (1.0 - x);  // exact
  if (z == 0) return {0.0, 0.0};
  const double root = std::sqrt(z), upper = upper_half(root);
  const double missing = ((z - upper * upper) - (root - upper) * (root + upper)) / (root + root);
  return {root, root * arcsine_excess(z) + missing};
}

/// (atan(u) - u) for |u| <= 1/16; minimax, relative error of atan 2^-62.
double arctangent_excess(double u) {
  const double z = u * u, z2 = z * z;
  const double a = -0x1.5555555555536p-2 + 0x1.999999996263cp-3 * z;
  const double b = -0x1.2492482710279p-3 + 0x1.c71879621e79dp-4 * z;
  return u * (z * (a + z2 * (b - z2 * 0x1.70bf3944cd6cap-4)));
}

/// atan(i / 16): the nearest double and the remainder.
constexpr double kArctangent[][2] = {
    {0x0p+0, 0x0p+0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};

/// atan(a / b) = atan(c) + u + rest, c = index / 16 and u = (a - c b) / (b + c a).
struct Arctangent {
  int index;
  double u, rest;
};

/// 0 <= a <= b, b > 0, finite.
Arctangent arctangent(double a, double b) {
  const double ratio = a / b;
  if (ratio < kSquareAddsNothing) return {0, ratio, 0.0};
  const double scale = b > 0x1p900 ? 0x1p-200 : b < 0x1p-800 ? 0x1p300 : 1.0;
  a *= scale;
  b *= scale;
  const double upper = upper_half(b), lower = b - upper;
  if (ratio < 0x1p-4) {  // the rounding error of the division matters
    const double first = upper_half(ratio), second = ratio - first;
    const double lost = ((a - first * upper) - first * lower - second * upper) - second * lower;
    return {0, ratio, arctangent_excess(ratio) + lost / b};
  }
  const int index = static_cast<int>(16.0 * ratio + 0.5);
  const double c = index / 16.0;  // c upper and c lower are exact, as c has five bits
  const double u = ((a - c * upper) - c * lower) / (b + c * a);
  return {index, u, arctangent_excess(u)};
}

}  // namespace

double sin(double x) {
  if (std::abs(x) < kSquareAddsNothing) return x;  // keeps the sign of -0
  const Turn t = turn_of(x);
  const double s = t.quadrant & 1 ? cosine(t.r, t.rest) : sine(t.r, t.rest);
  return t.quadrant & 2 ? -s : s;
}

double cos(double x) {
  const Turn t = turn_of(x);
  const double c = t.quadrant & 1 ? sine(t.r, t.rest) : cosine(t.r, t.rest);
  return (t.quadrant + 1) & 2 ? -c : c;
}

SineCosine sincos(double x) {
  if (std::abs(x) < kSquareAddsNothing) return {x, 1.0};
  const Turn t = turn_of(x);
  const double s = sine(t.r, t.rest), c = cosine(t.r, t.rest);
  const double first = t.quadrant & 1 ? c : s, second = t.quadrant & 1 ? s : c;
  return {t.quadrant & 2 ? -first : first, (t.quadrant + 1) & 2 ? -second : second};
}

double asin(double x) {
  const double size = std::abs(x);
  if (size <= 0.5) return x + x * arcsine_excess(x * x);
  if (!(size <= 1.0)) return kNan;
  const Sum half = half_arccosine(size);  // asin(x) = pi/2 - acos(x)
  const double sum = kHalfPi - 2.0 * half.most;
  const double lost = (kHalfPi - sum) - 2.0 * half.most;
  return std::copysign(sum + (lost + (kHalfPiRest - 2.0 * half.rest)), x);
}

double acos(double x) {
  if (!(std::abs(x) <= 1.0)) return kNan;
  if (x >= 0.5) {
    const Sum half = half_arccosine(x);
    return 2.0 * (half.most + half.rest);
  }
  // pi - acos(-x), or pi/2 - asin(x)
  const bool far = x <= -0.5;
  const Sum half = far ? half_arccosine(-x) : Sum{0.5 * x, 0.5 * x * arcsine_excess(x * x)};
  const double whole = far ? 2 * kHalfPi : kHalfPi, more = far ? 2 * kHalfPiRest : kHalfPiRest;
  const double sum = whole - 2.0 * half.most;
  const double lost = (whole - sum) - 2.0 * half.most;
  return sum + (lost + (more - 2.0 * half.rest));
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  double a = std::abs(y), b = std::abs(x);
  const bool steep = a > b, behind = std::signbit(x);
  if (steep) std::swap(a, b);
  if (std::isinf(b)) {
    a = std::isinf(a) ? 1.0 : 0.0;
    b = 1.0;
  }
  const Arctangent t = b == 0 ? Arctangent{0, 0.0, 0.0} : arctangent(a, b);
  // The angle of the first octant is added to, or subtracted from, a multiple of pi/2.
  const double sign = steep != behind ? -1.0 : 1.0;
  const double turns = steep ? 1.0 : behind ? 2.0 : 0.0;
  const double start = turns * kHalfPi, most = start + sign * kArctangent[t.index][0];
  const double lost = (start - most) + sign * kArctangent[t.index][0];
  const double angle = most + sign * t.u;
  const double lost_too = (most - angle) + sign * t.u;
  const double rest = sign * (kArctangent[t.index][1] + t.rest) + turns * kHalfPiRest;
  return std::copysign(angle + ((lost + lost_too) + rest), y);
}

}  // namespace scanlock
