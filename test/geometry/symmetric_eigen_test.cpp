// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/symmetric_eigen.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>

#include "bit_hash.hpp"
#include "random_reflections.hpp"

namespace scanlock {
namespace {

template <int kAxes>
using Square = Eigen::Matrix<double, kAxes, kAxes>;
template <int kAxes>
using Values = Eigen::Matrix<double, kAxes, 1>;

/// Checks against Eigen's iterative solver and against the definition of eigenvectors; errors relative to the
/// largest element.
template <int kAxes>
void check(const Square<kAxes>& a) {
  CAPTURE(a);
  const double size = std::max(a.cwiseAbs().maxCoeff(), std::numeric_limits<double>::denorm_min());
  const SymmetricEigen<kAxes> ours = symmetric_eigen(a);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> judge(a);
  CHECK((ours.values - judge.eigenvalues()).cwiseAbs().maxCoeff() <= 1e-14 * size);
  for (int k = 1; k < kAxes; ++k) CHECK(ours.values[k - 1] <= ours.values[k]);
  const Square<kAxes> v = ours.vectors;
  CHECK((v.transpose() * v - Square<kAxes>::Identity()).cwiseAbs().maxCoeff() < 2e-15);
  CHECK(((a / size) * v - v * (ours.values / size).asDiagonal()).cwiseAbs().maxCoeff() < 3e-15);
}

template <int kAxes>
Square<kAxes> with_eigenvalues(const Values<kAxes>& values, std::mt19937& random) {
  const Square<kAxes> q = random_reflections<Square<kAxes>>(random);
  const Square<kAxes> a = q * values.asDiagonal() * q.transpose();
  return 0.5 * (a + a.transpose());
}

}  // namespace

TEST_CASE("eigenvalues and eigenvectors are right, however near each other the eigenvalues are") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const double a = uniform(random), b = uniform(random), c = uniform(random);
    for (double apart : {1.0, 1e-3, 1e-6, 1e-8, 1e-10, 1e-14, 1e-16, 0.0}) {
      check<2>(with_eigenvalues<2>({a, a + apart * b}, random));
      check<2>(with_eigenvalues<2>({apart * b, a}, random));
      check<3>(with_eigenvalues<3>({a, a + apart * b, 2}, random));              // nearly a line
      check<3>(with_eigenvalues<3>({-1, a, a + apart * b}, random));             // nearly a plane
      check<3>(with_eigenvalues<3>({a, a + apart * b, a - apart * c}, random));  // nearly a ball
      check<3>(with_eigenvalues<3>({apart * apart * a, apart * b, c}, random));
      check<3>(with_eigenvalues<3>({apart * a, apart * b, c}, random));
      check<3>(with_eigenvalues<3>({apart * a, -b, c}, random));
    }
    const double size = std::ldexp(1.0, static_cast<int>(600 * a) - 300);
    check<2>(size * with_eigenvalues<2>({a, b}, random));
    check<3>(size * with_eigenvalues<3>({a, b, c}, random));
  }
}

TEST_CASE("matrices of entries -1, 0 and 1 have right eigenvectors, also with 1e9 on the diagonal") {
  for (int code = 0; code < 729; ++code) {
    const auto digit = [&](int place) { return static_cast<double>(code / place % 3 - 1); };
    Eigen::Matrix3d three;
    three << digit(1), digit(3), digit(9), digit(3), digit(27), digit(81), digit(9), digit(81), digit(243);
    check<3>(three);
    check<2>(three.topLeftCorner<2, 2>());
    three.diagonal().array() += 1e9;
    check<3>(three);
  }
}

TEST_CASE("only the lower triangle is read") {
  Eigen::Matrix3d a;
  a << 2, 9, 9, 1, 3, 9, 0.5, -1, 4;
  const Eigen::Matrix3d whole = a.selfadjointView<Eigen::Lower>();
  CHECK(symmetric_eigen(a).values == symmetric_eigen(whole).values);
  CHECK(symmetric_eigen(a).vectors == symmetric_eigen(whole).vectors);
}

TEST_CASE("a matrix that is not finite has NaN as eigenvalues and the axes of the frame as eigenvectors") {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Eigen::Matrix3d three = Eigen::Matrix3d::Identity();
    three(1, 0) = bad;
    CHECK(symmetric_eigen(three).values.array().isNaN().all());
    CHECK(symmetric_eigen(three).vectors == Eigen::Matrix3d::Identity());
    const Eigen::Matrix2d two = three.topLeftCorner<2, 2>();
    CHECK(symmetric_eigen(two).values.array().isNaN().all());
  }
}

TEST_CASE("eigenvalues and eigenvectors have the same bits everywhere") {
  BitHash bits;
  for (int i = 0; i < 4096; ++i) {
    const auto part = [&](int factor) { return static_cast<double>(i * factor % 97 - 48) * 0x1p-6; };
    Eigen::Matrix3d three;
    three << part(3), part(5), part(7), part(5), part(11), part(13), part(7), part(13), part(17);
    const Eigen::Matrix2d two = three.topLeftCorner<2, 2>();
    const SymmetricEigen<3> a = symmetric_eigen(three);
    const SymmetricEigen<2> b = symmetric_eigen(two);
    for (double x : a.values) bits.add(x);
    for (double x : a.vectors.reshaped()) bits.add(x);
    for (double x : b.values) bits.add(x);
    for (double x : b.vectors.reshaped()) bits.add(x);
  }
  CHECK(bits.value() == 0x5f9b8764d27a3e65);
}

}  // namespace scanlock
