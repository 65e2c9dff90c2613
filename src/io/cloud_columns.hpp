// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "io/cloud_file.hpp"

// What .ply and .pcd have in common: a table with named columns of any scalar type.
namespace scanlock {

enum class ScalarType : std::int8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};
std::size_t size_of(ScalarType type);

/// The scalar that begins at `bytes`, which must hold size_of(type) bytes.
double read_scalar(const std::uint8_t* bytes, ScalarType type, bool big_endian);

/// Rounds to float; what is too large becomes infinite.
float to_float(double value);

/// The array of a cloud that a column of this name and type belongs into, or null when we have no use for it.
/// Names are compared without regard to case.
using CloudArray = std::vector<float> PointCloud::*;
CloudArray array_for(std::string_view column, ScalarType type);

/// Where the points of a file go.
struct PointSink {
  TakePoints take;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< subtracted before coordinates become floats
};

/// Gathers the values of the columns that we use, point by point, and hands them on in clouds of many points.
class CloudTable {
 public:
  /// One entry for each column, null for those to be left out. `points`: as many as there will be, which the
  /// caller has checked; memory is taken for a part of them. With a column named twice the last wins.
  CloudTable(std::vector<CloudArray> columns, std::size_t points, const PointSink& sink);

  bool uses(std::size_t column) const { return columns_[column] != nullptr; }
  void set(std::size_t column, double value) {
    targets_[column][point_] = to_float(value - offsets_[column]);
  }
  /// All columns of a point were set.
  void end_point() {
    if (++point_ == part_) hand_on();
  }
  /// After the last point. Normals are handed on only when all three components were there.
  void hand_on();

 private:
  void begin_part();

  std::vector<CloudArray> columns_;
  std::vector<double> offsets_;  ///< of each column
  const PointSink& sink_;
  PointCloud cloud_;
  std::vector<float*> targets_;
  std::size_t left_;                  ///< points to come, with those of this part
  std::size_t part_ = 0, point_ = 0;  ///< points of this part, and those that are complete
};

/// The name of the coordinate that is missing among the columns, or empty.
std::string missing_coordinate(const std::vector<CloudArray>& columns);

/// The columns of a cloud that are there, by the names that we write: x y z, then the optional ones.
struct NamedArray {
  const char* name;
  const std::vector<float>* values;
};
std::vector<NamedArray> columns_of(const PointCloud& cloud, const char* normal_x = "nx",
                                   const char* normal_y = "ny", const char* normal_z = "nz");

/// Appends all points, point by point, as little-endian float32.
void append_rows(std::string& bytes, const std::vector<NamedArray>& columns);

/// Throws std::runtime_error "PATH: byte OFFSET: what".
[[noreturn]] void fail_at_byte(const std::string& path, std::size_t offset, const std::string& what);

}  // namespace scanlock
