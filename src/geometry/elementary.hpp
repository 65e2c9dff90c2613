// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

namespace scanlock {

// The elementary functions of everything that poses and messages depend on. Those of the C library round
// differently between libraries, and in one library between processors (glibc takes another variant where
// there is FMA). These are made of +, -, *, / and sqrt alone, which IEEE 754 rounds in one way, so their bits
// are the same on every processor, compiler and library. It takes -ffp-contract=off, rounding to nearest and
// subnormal numbers, as programs have them unless they ask for something else.
//
// Errors are in units in the last place (ulp) of the result: bounds on the largest that 3e7 random arguments
// of each range in test/geometry/elementary_test.cpp showed against long double; 1 ulp for results that are
// subnormal. NaN gives NaN, and so does what is outside the domain.

double exp(double x);    ///< 0.9 ulp
double expm1(double x);  ///< e^x - 1; 1.1 ulp
double exp2(double x);   ///< 0.9 ulp, exact for integers
double log(double x);    ///< 0.95 ulp
double log1p(double x);  ///< log(1 + x); 0.95 ulp
double log2(double x);   ///< 1.2 ulp, exact for powers of two

struct SineCosine {
  double sine, cosine;
};
/// Radians; 0.95 ulp up to 2^20. Larger arguments are taken modulo the double next to 2 pi, an error below
/// that of their own rounding; the result stays within [-1, 1]. NaN for infinity.
double sin(double x);
double cos(double x);
SineCosine sincos(double x);

double asin(double x);             ///< 0.7 ulp
double acos(double x);             ///< 0.7 ulp
double atan2(double y, double x);  ///< in [-pi, pi], zeros and infinities as in IEEE 754; 0.9 ulp
double hypot(double x, double y);  ///< 0.51 ulp, without overflow or underflow on the way

// In float: through double, hence correctly rounded but for one result in about 10^8.
inline float sin(float x) {
  return static_cast<float>(sin(static_cast<double>(x)));
}
inline float cos(float x) {
  return static_cast<float>(cos(static_cast<double>(x)));
}
inline float asin(float x) {
  return static_cast<float>(asin(static_cast<double>(x)));
}
inline float atan2(float y, float x) {
  return static_cast<float>(atan2(static_cast<double>(y), static_cast<double>(x)));
}
inline float hypot(float x, float y) {
  return static_cast<float>(hypot(static_cast<double>(x), static_cast<double>(y)));
}

}  // namespace scanlock
