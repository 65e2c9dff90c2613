// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/trajectory.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "io/byte_source.hpp"
#include "io/file_bytes.hpp"
#include "io/text_lines.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
constexpr double kRotationTolerance = 1e-3;
constexpr double kPrintedTolerance = 1e-6;  // a matrix this close to a rotation is stored unchanged

StampedPose tum_pose(const TextLines& lines, const std::vector<double>& v) {
  if (v.size() != kTumColumns)
    lines.fail("a TUM line has 8 numbers (time tx ty tz qx qy qz qw), this one has " +
               std::to_string(v.size()));
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1) > kQuaternionTolerance)
    lines.fail("the quaternion has length " + std::to_string(q.norm()) + " instead of 1");
  StampedPose stamped;
  stamped.time_s = v[0];
  stamped.pose.linear() = q.normalized().toRotationMatrix();
  stamped.pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
  return stamped;
}

StampedPose kitti_pose(const TextLines& lines, const std::vector<double>& v, std::size_t number) {
  if (v.size() != kKittiColumns)
    lines.fail("a KITTI line has 12 numbers (three rows of a 4x4 matrix), this one has " +
               std::to_string(v.size()));
  StampedPose stamped;
  stamped.time_s = static_cast<double>(number);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) stamped.pose(row, column) = v[4 * row + column];
  }
  const Eigen::Matrix3d rotation = stamped.pose.linear();
  const double off = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationTolerance) || rotation.determinant() < 0) lines.fail("the matrix is not a rotation");
  if (off > kPrintedTolerance) stamped.pose = renormalised(stamped.pose);
  return stamped;
}

/// Parses every line of the file as a pose with that number of columns.
Trajectory read_lines(const std::string& path, std::size_t columns) {
  ByteSource source(path);
  TextLines lines(path, source);
  Trajectory trajectory;
  std::vector<double> numbers;
  while (const auto line = lines.next_with_content()) {
    lines.parse_finite(*line, numbers);
    trajectory.push_back(columns == kTumColumns ? tum_pose(lines, numbers)
                                                : kitti_pose(lines, numbers, trajectory.size()));
  }
  return trajectory;
}

void append(std::string& text, const char* format, double value) {
  std::array<char, 512> buffer{};  // the longest double with nine decimals has 320 characters
  const int size = std::snprintf(buffer.data(), buffer.size(), format, value);
  text.append(buffer.data(), static_cast<std::size_t>(size));
}

}  // namespace

Trajectory read_tum(const std::string& path) {
  return read_lines(path, kTumColumns);
}

Trajectory read_kitti(const std::string& path) {
  return read_lines(path, kKittiColumns);
}

bool is_tum(const std::string& path) {
  ByteSource source(path);
  TextLines lines(path, source);
  const auto line = lines.next_with_content();
  if (!line) lines.fail("the file holds no pose");
  const std::size_t columns = split_words(*line).size();
  if (columns != kTumColumns && columns != kKittiColumns)
    lines.fail("neither TUM (8 numbers a line) nor KITTI (12): this line has " + std::to_string(columns) +
               " words");
  return columns == kTumColumns;
}

Trajectory read_trajectory(const std::string& path) {
  return is_tum(path) ? read_tum(path) : read_kitti(path);
}

void write_tum(const std::string& path, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& stamped : trajectory) {
    Eigen::Quaterniond q(stamped.pose.linear());
    if (q.w() < 0) q.coeffs() *= -1;  // q and -q are the same rotation; always write w >= 0
    append(text, "%.6f", stamped.time_s);
    for (int i = 0; i < 3; ++i) append(text, " %.9f", stamped.pose.translation()[i]);
    for (int i = 0; i < 4; ++i) append(text, " %.9f", q.coeffs()[i]);  // x y z w
    text += '\n';
  }
  write_file_bytes(path, text);
}

void write_kitti(const std::string& path, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& stamped : trajectory) {
    for (int i = 0; i < 12; ++i) append(text, i == 0 ? "%.9f" : " %.9f", stamped.pose(i / 4, i % 4));
    text += '\n';
  }
  write_file_bytes(path, text);
}

}  // namespace scanlock
