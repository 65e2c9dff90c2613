// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/elementary.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "bit_hash.hpp"
#include "geometry/angles.hpp"

namespace scanlock {
namespace {

using Limits = std::numeric_limits<double>;
constexpr double kInfinity = Limits::infinity();

/// The error of a result in units of the last place of the true value.
double ulps(double got, long double truth) {
  const double nearest = static_cast<double>(truth);
  if (std::isinf(nearest) || std::isinf(got)) return nearest == got ? 0 : kInfinity;
  int exponent = 0;
  std::frexp(nearest, &exponent);
  const double ulp = std::ldexp(1.0, std::max(exponent - 53, -1074));
  return static_cast<double>(std::abs(static_cast<long double>(got) - truth) / ulp);
}

using Draw = std::function<double(double)>;  // from [0, 1) to an argument

Draw between(double low, double high) {
  return [=](double u) { return low + (high - low) * u; };
}
/// Arguments of every order of magnitude from 2^low to 2^high.
Draw powers(double low, double high) {
  return [=](double u) { return std::exp2(low + (high - low) * u); };
}
Draw plus(double start, double sign, const Draw& draw) {
  return [=](double u) { return start + sign * draw(u); };
}

struct Range {
  const char* name;
  double (*ours)(double);
  long double (*truth)(long double);
  Draw draw;
  double bound;  // ulp
};

const std::vector<Range> kRanges = {
    {"exp", exp, std::exp, between(-708, 709.5), 0.9},
    {"exp near 0", exp, std::exp, between(-1, 1), 0.9},
    {"exp, subnormal", exp, std::exp, between(-745, -708), 1.0},
    {"expm1", expm1, std::expm1, between(-45, 709), 1.1},
    {"expm1 near 0", expm1, std::expm1, between(-1.5, 1.5), 1.1},
    {"expm1, tiny", expm1, std::expm1, plus(0, -1, powers(-80, 0)), 1.1},
    {"exp2", exp2, std::exp2, between(-1021, 1023), 0.9},
    {"exp2 near 0", exp2, std::exp2, between(-1, 1), 0.9},
    {"log", log, std::log, powers(-1074, 1023.9), 0.95},
    {"log near 1", log, std::log, between(0.5, 2), 0.95},
    {"log next to 1", log, std::log, plus(1, -1, powers(-50, -1)), 0.95},
    {"log1p", log1p, std::log1p, powers(-60, 1000), 0.95},
    {"log1p below 0", log1p, std::log1p, between(-1, 0), 0.95},
    {"log2", log2, std::log2, powers(-1074, 1023.9), 1.2},
    {"log2 near 1", log2, std::log2, between(0.5, 2), 1.2},
    {"sin", sin, std::sin, between(-10, 10), 0.95},
    {"sin, tiny", sin, std::sin, powers(-80, 0), 0.95},
    {"sin, large", sin, std::sin, between(-0x1p20, 0x1p20), 0.95},
    {"cos", cos, std::cos, between(-10, 10), 0.95},
    {"cos, large", cos, std::cos, between(-0x1p20, 0x1p20), 0.95},
    {"sin near pi", sin, std::sin, plus(kPi, 1, powers(-52, -2)), 0.95},
    {"cos near a multiple of pi / 2", cos, std::cos, plus(667543 * (kPi / 2), -1, powers(-33, -2)), 0.95},
    {"asin", asin, std::asin, between(-1, 1), 0.7},
    {"asin, tiny", asin, std::asin, powers(-80, 0), 0.7},
    {"asin near 1", asin, std::asin, plus(1, -1, powers(-53, -1)), 0.7},
    {"acos", acos, std::acos, between(-1, 1), 0.7},
    {"acos near 1", acos, std::acos, plus(1, -1, powers(-53, -1)), 0.7},
    {"acos near -1", acos, std::acos, plus(-1, 1, powers(-53, -1)), 0.7},
};

}  // namespace

TEST_CASE("elementary functions are as accurate as documented") {
  if (std::numeric_limits<long double>::digits < 64) return;  // no reference of higher precision
  std::mt19937_64 random(7);
  const auto draw = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (const Range& range : kRanges) {
    CAPTURE(range.name);
    double worst = 0;
    for (int i = 0; i < 50000; ++i) {
      const double x = range.draw(draw());
      worst = std::max(worst, ulps(range.ours(x), range.truth(static_cast<long double>(x))));
    }
    CHECK(worst < range.bound);
    CHECK(worst > 0.45);  // otherwise nothing was measured
  }
}

TEST_CASE("arc tangent and hypotenuse are accurate in every direction and at every size") {
  if (std::numeric_limits<long double>::digits < 64) return;
  std::mt19937_64 random(8);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  const auto sign = [&] { return random() & 1 ? 1.0 : -1.0; };
  double angle = 0, any_angle = 0, length = 0, any_length = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto off = [](double got, long double truth) { return ulps(got, truth); };
    double x = draw(-1, 1), y = draw(-1, 1);
    angle = std::max(angle, off(atan2(y, x), std::atan2(static_cast<long double>(y), x)));
    length = std::max(length, off(hypot(y, x), std::hypot(static_cast<long double>(y), x)));
    x = sign() * std::exp2(draw(-1074, 1023));
    y = sign() * std::exp2(draw(-1074, 1023));
    any_angle = std::max(any_angle, off(atan2(y, x), std::atan2(static_cast<long double>(y), x)));
    y = x * std::exp2(draw(-40, 0));
    any_angle = std::max(any_angle, off(atan2(y, x), std::atan2(static_cast<long double>(y), x)));
    any_length = std::max(any_length, off(hypot(y, x), std::hypot(static_cast<long double>(y), x)));
  }
  CHECK(angle < 0.9);
  CHECK(any_angle < 1.0);  // subnormal angles
  CHECK(length < 0.51);
  CHECK(any_length < 1.0);  // subnormal lengths
}

TEST_CASE("elementary functions are right at the ends of their ranges") {
  const double nan = Limits::quiet_NaN();
  for (double (*f)(double) : {static_cast<double (*)(double)>(exp), static_cast<double (*)(double)>(expm1),
                              static_cast<double (*)(double)>(exp2), static_cast<double (*)(double)>(log),
                              static_cast<double (*)(double)>(log1p), static_cast<double (*)(double)>(log2),
                              static_cast<double (*)(double)>(sin), static_cast<double (*)(double)>(cos),
                              static_cast<double (*)(double)>(asin), static_cast<double (*)(double)>(acos)})
    CHECK(std::isnan(f(nan)));
  CHECK(exp(0.0) == 1.0);
  CHECK(exp(-kInfinity) == 0.0);
  CHECK(exp(kInfinity) == kInfinity);
  CHECK(exp(709.782712893384) < kInfinity);
  CHECK(exp(709.7827128933841) == kInfinity);
  CHECK(exp(1e300) == kInfinity);
  CHECK(exp(-745.2) == 0.0);
  CHECK(exp(-745.1) == Limits::denorm_min());
  CHECK(exp(-1e300) == 0.0);
  CHECK(expm1(-kInfinity) == -1.0);
  CHECK(expm1(kInfinity) == kInfinity);
  CHECK(expm1(710) == kInfinity);
  CHECK(std::signbit(expm1(-0.0)));
  CHECK(expm1(-1e-300) == -1e-300);
  for (int k = -1074; k < 1024; ++k) {
    CHECK(exp2(static_cast<double>(k)) == std::ldexp(1.0, k));
    CHECK(log2(std::ldexp(1.0, k)) == k);
  }
  CHECK(exp2(1024.0) == kInfinity);
  CHECK(exp2(-1076.0) == 0.0);
  for (double (*f)(double) : {static_cast<double (*)(double)>(log), static_cast<double (*)(double)>(log2)}) {
    CHECK(f(1.0) == 0.0);
    CHECK(f(0.0) == -kInfinity);
    CHECK(f(-0.0) == -kInfinity);
    CHECK(f(kInfinity) == kInfinity);
    CHECK(std::isnan(f(-1.0)));
    CHECK(std::isnan(f(-kInfinity)));
  }
  CHECK(log1p(-1.0) == -kInfinity);
  CHECK(log1p(kInfinity) == kInfinity);
  CHECK(std::signbit(log1p(-0.0)));
  CHECK(std::isnan(log1p(-1.5)));
  CHECK(asin(1.0) == kPi / 2);
  CHECK(asin(-1.0) == -kPi / 2);
  CHECK(std::signbit(asin(-0.0)));
  CHECK(acos(1.0) == 0.0);
  CHECK(acos(-1.0) == kPi);
  CHECK(acos(0.0) == kPi / 2);
  CHECK(std::isnan(asin(1.0 + Limits::epsilon())));
  CHECK(std::isnan(acos(-1.0 - Limits::epsilon())));
  CHECK(hypot(3.0, -4.0) == 5.0);
  CHECK(hypot(0.0, -0.0) == 0.0);
  CHECK(hypot(-kInfinity, nan) == kInfinity);
  CHECK(std::isnan(hypot(nan, 1.0)));
  CHECK(std::isnan(hypot(1.0, nan)));
  CHECK(hypot(Limits::max(), Limits::max()) == kInfinity);
  CHECK(hypot(Limits::max(), 1.0) == Limits::max());
  CHECK(hypot(Limits::denorm_min(), 0.0) == Limits::denorm_min());
}

TEST_CASE("the arc tangent handles zeros and infinities with their signs") {
  for (double y : {-kInfinity, -Limits::max(), -1.0, -Limits::denorm_min(), -0.0, 0.0, Limits::denorm_min(),
                   1.0, Limits::max(), kInfinity}) {
    for (double x : {-kInfinity, -Limits::max(), -1.0, -Limits::denorm_min(), -0.0, 0.0, Limits::denorm_min(),
                     1.0, Limits::max(), kInfinity}) {
      CAPTURE(y);
      CAPTURE(x);
      CHECK(std::abs(atan2(y, x) - std::atan2(y, x)) <= 4.5e-16);
      CHECK(std::signbit(atan2(y, x)) == std::signbit(y));
      if (std::atan2(y, x) == 0) CHECK(atan2(y, x) == 0);
    }
    CHECK(std::isnan(atan2(y, Limits::quiet_NaN())));
    CHECK(std::isnan(atan2(Limits::quiet_NaN(), y)));
  }
  CHECK(atan2(0.0, -1.0) == kPi);
  CHECK(atan2(-0.0, -1.0) == -kPi);
  CHECK(atan2(1.0, 0.0) == kPi / 2);
  CHECK(atan2(1.0, 1.0) == kPi / 4);
}

TEST_CASE("sine and cosine of any number belong to one angle, and are symmetric in its sign") {
  std::mt19937_64 random(9);
  for (int i = 0; i < 20000; ++i) {
    const double x = std::exp2(-60 + 1083 * (static_cast<double>(random() >> 11) * 0x1p-53));
    const auto [s, c] = sincos(x);
    CHECK(s == sin(x));
    CHECK(c == cos(x));
    CHECK(sin(-x) == -s);
    CHECK(cos(-x) == c);
    CHECK(std::abs(s) <= 1.0);
    CHECK(std::abs(c) <= 1.0);
    CHECK(std::abs(s * s + c * c - 1.0) < 5e-16);
    // The change of the result for another number that rounds to x.
    const double slack = 5e-16 + (x > 0x1p20 ? x * 0x1p-53 : 0.0);
    if (slack < 1) CHECK(std::abs(s - std::sin(x)) < slack);
  }
  CHECK(std::signbit(sin(-0.0)));
  CHECK(cos(0.0) == 1.0);
  CHECK(std::isnan(sin(kInfinity)));
  CHECK(std::isnan(cos(-kInfinity)));
  CHECK(std::isnan(sincos(kInfinity).sine));
}

TEST_CASE("elementary functions are monotonic where two pieces of their approximation meet") {
  const auto rises = [](double (*f)(double), double border) {
    const double step = std::abs(border) * 0x1p-48;
    for (int i = -64; i < 64; ++i) {
      const double x = border + i * step;
      if (!(f(x) <= f(x + step))) return false;
    }
    return true;
  };
  for (int k = -9; k < 10; k += 2) {
    CHECK(rises(exp, k * std::log(2.0) / 2));
    CHECK(rises(expm1, k * std::log(2.0) / 2));
    CHECK(rises(exp2, k / 2.0));
    CHECK(rises(log, std::ldexp(std::sqrt(0.5), k)));
    CHECK(rises(log2, std::ldexp(std::sqrt(0.5), k)));
  }
  CHECK(rises(log1p, std::sqrt(0.5) - 1));
  CHECK(rises(log1p, std::sqrt(2.0) - 1));
  CHECK(rises(sin, kPi / 4));
  CHECK(rises([](double x) { return -cos(x); }, kPi / 4));
  CHECK(rises(asin, 0.5));
  CHECK(rises([](double x) { return -acos(x); }, 0.5));
  CHECK(rises([](double x) { return -acos(x); }, -0.5));
  for (int i = 1; i < 32; ++i) CHECK(rises([](double y) { return atan2(y, 1.0); }, i / 32.0));
  CHECK(rises([](double y) { return atan2(y, 1.0); }, 1.0));
}

TEST_CASE("elementary functions have the same bits everywhere") {
  const auto hash = [](double (*f)(double), double from, double step) {
    BitHash bits;
    for (int i = 0; i < 4096; ++i) bits.add(f(from + i * step));
    return bits.value();
  };
  // Steps and starts are sums of few powers of two, hence exact.
  CHECK(hash(exp, -20, 0x1.3p-7) == 0xc161bebd1aed612e);
  CHECK(hash(exp, -750, 0x1.7p-2) == 0x33a0eecb31bf80d5);
  CHECK(hash(expm1, -20, 0x1.3p-7) == 0xffcdd8f9906ba326);
  CHECK(hash(exp2, -20, 0x1.3p-7) == 0xa38e2549dc8c2811);
  CHECK(hash(log, 0x1p-9, 0x1.3p-7) == 0xda90fa1bc4db3be3);
  CHECK(hash(log1p, -1, 0x1.3p-7) == 0xbc4cfd0efcc9f8aa);
  CHECK(hash(log2, 0x1p-9, 0x1.3p-7) == 0x23eb75bb4bfbf7a2);
  CHECK(hash(sin, -20, 0x1.3p-7) == 0x91ef585a43f5d90f);
  CHECK(hash(sin, -0x1p22, 0x1.3p11) == 0xd5acacd08ead0505);
  CHECK(hash(cos, -20, 0x1.3p-7) == 0xe9a8d7953a3ed23f);
  CHECK(hash(asin, -1, 0x1p-11) == 0xf5ade5ad84448c52);
  CHECK(hash(acos, -1, 0x1p-11) == 0x62c7b2ac79432aab);
  BitHash angles, lengths;
  for (int i = -64; i < 64; ++i) {
    for (int j = -64; j < 64; ++j) {
      angles.add(atan2(i * 0x1.3p-3, j * 0x1.7p-3));
      lengths.add(hypot(i * 0x1.3p-3, j * 0x1.7p-3));
    }
  }
  CHECK(angles.value() == 0xd5d148657bafc548);
  CHECK(lengths.value() == 0xecd1af9c9c7ad97d);
}

TEST_CASE("functions in float are the rounded functions in double") {
  for (float x = -0.99f; x < 1; x += 0.017f) {
    const double wide = static_cast<double>(x);
    CHECK(sin(x) == static_cast<float>(sin(wide)));
    CHECK(cos(x) == static_cast<float>(cos(wide)));
    CHECK(asin(x) == static_cast<float>(asin(wide)));
    CHECK(atan2(x, 0.3f) == static_cast<float>(atan2(wide, static_cast<double>(0.3f))));
    CHECK(hypot(x, 0.3f) == static_cast<float>(hypot(wide, static_cast<double>(0.3f))));
  }
}

}  // namespace scanlock
