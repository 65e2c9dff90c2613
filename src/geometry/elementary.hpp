// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

namespace scanlock {

// The elementary functions for all computations that poses and messages depend on. The functions of the C
// library round differently between libraries, and within one library between processors (glibc has separate
// variants for processors with FMA). The functions below use only +, -, *, / and sqrt, whose rounding
// IEEE 754 defines, so their results are equal to the bit on every processor, compiler and library. This
// requires -ffp-contract=off, and rounding to nearest and subnormal numbers, which are a program's defaults.
//
// Errors are in units in the last place (ulp) of the result: upper bounds on the largest error against long
// double over 3e7 random arguments of each range in test/geometry/elementary_test.cpp; 1 ulp for subnormal
// results. The result is NaN for NaN and for arguments outside the domain.

double exp(double x);    ///< 0.9 ulp
double expm1(double x);  ///< e^x - 1; 1.1 ulp
double exp2(double x);   ///< 0.9 ulp, exact for integers
double log(double x);    ///< 0.95 ulp
double log1p(double x);  ///< log(1 + x); 0.95 ulp
double log2(double x);   ///< 1.2 ulp, exact for powers of two

struct SineCosine {
  double sine, cosine;
};
/// Radians; 0.95 ulp for arguments up to 2^20. Larger arguments are reduced modulo the double nearest to
/// 2 pi, which causes an error below the rounding error of the argument itself; the result stays within
/// [-1, 1]. NaN for infinity.
double sin(double x);
double cos(double x);
SineCosine sincos(double x);

double asin(double x);             ///< 0.7 ulp
double acos(double x);             ///< 0.7 ulp
double atan2(double y, double x);  ///< in [-pi, pi], zeros and infinities as in IEEE 754; 0.9 ulp
double hypot(double x, double y);  ///< 0.51 ulp, without overflow or underflow of intermediate values

// Float variants: computed in double, hence correctly rounded except for about one result in 10^8.
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
