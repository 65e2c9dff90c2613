// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/symmetric_eigen.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace scanlock {
namespace {

/// A fixed order of summation: that of Eigen depends on the platform.
double dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

/// For the matrix [a b; b c]: the mean of its eigenvalues, half their difference, and the unit eigenvector
/// (cosine, sine) of the larger one. The squares of elements must neither overflow nor all underflow.
struct Pair {
  double mean, half, cosine, sine;
};

Pair solve_pair(double a, double b, double c) {
  const double h = 0.5 * (a - c), half = std::sqrt(h * h + b * b);
  Pair pair{0.5 * (a + c), half, 1.0, 0.0};
  const double x = h >= 0 ? half + h : b, y = h >= 0 ? b : half - h;  // sums without cancellation
  const double length = std::sqrt(x * x + y * y);
  if (length > 0) {
    pair.cosine = x / length;
    pair.sine = y / length;
  }
  return pair;
}

/// The largest root of t^3 - 3 t = 2 r for 0 <= r <= 1, which is 2 cos(acos(r) / 3). It lies in [sqrt(3), 2],
/// at least sqrt(3) above the other two roots, so that two Newton steps converge from the polynomial guess,
/// whose error is 8e-6.
double largest_root(double r) {
  double t = 1.7320587 + r * (0.33289076 + r * (-0.092173844 + r * (0.035545765 - r * 0.0083292321)));
  for (int step = 0; step < 2; ++step) t -= ((t * t - 3.0) * t - 2.0 * r) / (3.0 * (t * t - 1.0));
  return t;
}

/// For matrices whose largest element is between 1e-51 and 1e50.
SymmetricEigen<3> solve_three(const Eigen::Matrix3d& a) {
  const double mean = (a(0, 0) + a(1, 1) + a(2, 2)) / 3.0;
  const double x = a(0, 0) - mean, y = a(1, 1) - mean, z = a(2, 2) - mean;
  const double d = a(1, 0), e = a(2, 0), f = a(2, 1);
  const double spread = std::sqrt((x * x + y * y + z * z + 2.0 * (d * d + e * e + f * f)) / 6.0);
  if (!(spread > 1e-20 * std::abs(mean)))
    return {Eigen::Vector3d::Constant(mean), Eigen::Matrix3d::Identity()};
  // The eigenvalues of (A - mean) / spread are the roots t of t^3 - 3 t = 2 r. Of the smallest and the
  // largest eigenvalue, the one farther from the middle eigenvalue is well separated for every r: its
  // eigenvector is the longest of the cross products of the rows of A - t. The other two eigenvectors are
  // found in the perpendicular plane.
  const double determinant = x * (y * z - f * f) - d * (d * z - f * e) + e * (d * f - y * e);
  const double r = determinant / (2.0 * spread * spread * spread);
  const bool largest = r >= 0;
  const double root = spread * largest_root(std::min(std::abs(r), 1.0)), apart = largest ? root : -root;
  const Eigen::Vector3d row[] = {{x - apart, d, e}, {d, y - apart, f}, {e, f, z - apart}};
  Eigen::Vector3d across = row[0].cross(row[1]);
  double square = dot(across, across);
  for (const Eigen::Vector3d& other : {row[0].cross(row[2]).eval(), row[1].cross(row[2]).eval()}) {
    const double other_square = dot(other, other);
    if (!(other_square > square)) continue;
    across = other;
    square = other_square;
  }
  const Eigen::Vector3d axis = across / std::sqrt(square);
  // The reflection that maps the axis to the positive or negative z axis maps x and y into the plane
  // perpendicular to the axis.
  const double sign = std::copysign(1.0, axis.z()), c = 1.0 / (axis.z() + sign);
  const double cx = c * axis.x(), cy = c * axis.y();
  const Eigen::Vector3d u(1.0 - sign * cx * axis.x(), -sign * cx * axis.y(), -sign * axis.x());
  const Eigen::Vector3d v(-cx * axis.y(), sign - cy * axis.y(), -axis.y());
  const Eigen::Vector3d centred[] = {{x, d, e}, {d, y, f}, {e, f, z}};
  const auto product = [&](const Eigen::Vector3d& w) {
    return Eigen::Vector3d(dot(centred[0], w), dot(centred[1], w), dot(centred[2], w));
  };
  const Pair pair = solve_pair(dot(u, product(u)), dot(u, product(v)), dot(v, product(v)));
  const double larger = mean + (pair.mean + pair.half), smaller = mean + (pair.mean - pair.half);
  const Eigen::Vector3d first = pair.cosine * u + pair.sine * v, second = pair.cosine * v - pair.sine * u;
  SymmetricEigen<3> result;
  if (largest) {
    result.values << smaller, larger, mean + apart;
    result.vectors << second, first, axis;
  } else {
    result.values << mean + apart, smaller, larger;
    result.vectors << axis, second, first;
  }
  return result;
}

SymmetricEigen<2> solve_two(const Eigen::Matrix2d& a) {
  const Pair pair = solve_pair(a(0, 0), a(1, 0), a(1, 1));
  SymmetricEigen<2> result;
  result.values << pair.mean - pair.half, pair.mean + pair.half;
  result.vectors << -pair.sine, pair.cosine, pair.cosine, pair.sine;
  return result;
}

/// Solves `a`, scaled by a power of two where squares of its elements would leave the range of doubles.
template <int kAxes, typename Solve>
SymmetricEigen<kAxes> in_range(const Eigen::Matrix<double, kAxes, kAxes>& a, const Solve& solve) {
  double size = 0;
  for (int column = 0; column < kAxes; ++column)
    for (int row = column; row < kAxes; ++row) size += std::abs(a(row, column));
  if (size > 1e-50 && size < 1e50) return solve(a);
  using Vector = Eigen::Matrix<double, kAxes, 1>;
  using Matrix = Eigen::Matrix<double, kAxes, kAxes>;
  if (size == 0) return {Vector::Zero(), Matrix::Identity()};
  if (!(size < std::numeric_limits<double>::max()))
    return {Vector::Constant(std::numeric_limits<double>::quiet_NaN()), Matrix::Identity()};
  int exponent = 0;
  std::frexp(size, &exponent);
  SymmetricEigen<kAxes> result =
      solve(a.unaryExpr([&](double element) { return std::ldexp(element, -exponent); }).eval());
  result.values = result.values.unaryExpr([&](double value) { return std::ldexp(value, exponent); }).eval();
  return result;
}

}  // namespace

SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& a) {
  return in_range<2>(a, solve_two);
}

SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a) {
  return in_range<3>(a, solve_three);
}

}  // namespace scanlock
