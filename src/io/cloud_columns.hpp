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

// The common part of .ply and .pcd: a table with named columns of any scalar type.
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

/// Rounds to float; values beyond the range of float become infinite.
float to_float(double value);

/// The array of PointCloud in which a column of this name and type is stored, or null when scanlock does not
/// use the column. Names are compared without regard to case.
using CloudArray = std::vector<float> PointCloud::*;
CloudArray array_for(std::string_view column, ScalarType type);

/// Receives the points of a file.
struct PointSink {
  TakePoints take;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< metres, subtracted before coordinates become floats
};

/// Collects the values of the used columns, point by point, and passes them on in clouds of kPartPoints
/// points.
class CloudTable {
 public:
  /// `columns`: one entry per column, null for a column to be ignored. `points`: their number, which the
  /// caller has checked against the size of the file; memory is allocated for at most kPartPoints of them.
  /// When two columns have the same name, the last one is used.
  CloudTable(std::vector<CloudArray> columns, std::size_t points, const PointSink& sink);

  bool uses(std::size_t column) const { return columns_[column] != nullptr; }
  void set(std::size_t column, double value) {
    targets_[column][point_] = to_float(value - offsets_[column]);
  }
  /// To be called when all used columns of a point are set.
  void end_point() {
    if (++point_ == part_) hand_on();
  }
  /// To be called after the last point. Normals are passed on only when all three components have a column.
  void hand_on();

 private:
  void begin_part();

  std::vector<CloudArray> columns_;
  std::vector<double> offsets_;  ///< of each column, subtracted from its values
  const PointSink& sink_;
  PointCloud cloud_;
  std::vector<float*> targets_;
  std::size_t left_;                  ///< points not yet passed on, including those of this part
  std::size_t part_ = 0, point_ = 0;  ///< points of this part, and how many of them are complete
};

/// The name of the first of x, y, z that no column provides; empty when all three are present.
std::string missing_coordinate(const std::vector<CloudArray>& columns);

/// The non-empty columns of a cloud under the names that scanlock writes: x y z, then normals, intensity and
/// time.
struct NamedArray {
  const char* name;
  const std::vector<float>* values;
};
std::vector<NamedArray> columns_of(const PointCloud& cloud, const char* normal_x = "nx",
                                   const char* normal_y = "ny", const char* normal_z = "nz");

/// Appends all points as rows of little-endian float32.
void append_rows(std::string& bytes, const std::vector<NamedArray>& columns);

/// Throws std::runtime_error "PATH: byte OFFSET: what".
[[noreturn]] void fail_at_byte(const std::string& path, std::size_t offset, const std::string& what);

}  // namespace scanlock
