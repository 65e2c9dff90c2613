// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/cloud_columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace scanlock {
namespace {

struct KnownColumn {
  std::string_view name;
  CloudArray array;
};
constexpr std::array<KnownColumn, 11> kKnownColumns = {{
    {"x", &PointCloud::x},
    {"y", &PointCloud::y},
    {"z", &PointCloud::z},
    {"nx", &PointCloud::nx},
    {"ny", &PointCloud::ny},
    {"nz", &PointCloud::nz},
    {"normal_x", &PointCloud::nx},
    {"normal_y", &PointCloud::ny},
    {"normal_z", &PointCloud::nz},
    {"intensity", &PointCloud::intensity},
    {"scalar_intensity", &PointCloud::intensity},  // the name that CloudCompare writes
}};

template <typename T>
double from_bits(std::uint64_t bits) {
  T value;
  std::memcpy(&value, &bits, sizeof value);  // low-order bytes, on a little-endian machine
  return static_cast<double>(value);
}

}  // namespace

std::size_t size_of(ScalarType type) {
  constexpr std::array<std::size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

double read_scalar(const std::uint8_t* bytes, ScalarType type, bool big_endian) {
  const std::size_t size = size_of(type);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) bits = (bits << 8) | bytes[big_endian ? i : size - 1 - i];
  switch (type) {
    case ScalarType::kInt8:
      return static_cast<std::int8_t>(bits);
    case ScalarType::kUint8:
      return static_cast<std::uint8_t>(bits);
    case ScalarType::kInt16:
      return static_cast<std::int16_t>(bits);
    case ScalarType::kUint16:
      return static_cast<std::uint16_t>(bits);
    case ScalarType::kInt32:
      return static_cast<std::int32_t>(bits);
    case ScalarType::kUint32:
      return static_cast<std::uint32_t>(bits);
    case ScalarType::kInt64:
      return static_cast<double>(static_cast<std::int64_t>(bits));
    case ScalarType::kUint64:
      return static_cast<double>(bits);
    case ScalarType::kFloat32:
      return from_bits<float>(bits);
    case ScalarType::kFloat64:
      return from_bits<double>(bits);
  }
  return 0;
}

float to_float(double value) {
  if (std::abs(value) > std::numeric_limits<float>::max())  // false for NaN
    return std::copysign(std::numeric_limits<float>::infinity(), value > 0 ? 1.f : -1.f);
  return static_cast<float>(value);
}

CloudArray array_for(std::string_view column, ScalarType type) {
  std::string name(column);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // Some drivers' `time` columns hold nanoseconds or seconds since the epoch. A float32 is too coarse for
  // either, so a float32 column must hold relative seconds.
  if (name == "time") return type == ScalarType::kFloat32 ? &PointCloud::time : nullptr;
  for (const KnownColumn& known : kKnownColumns)
    if (known.name == name) return known.array;
  return nullptr;
}

CloudTable::CloudTable(std::vector<CloudArray> columns, std::size_t points, const PointSink& sink)
    : columns_(std::move(columns)), sink_(sink), left_(points) {
  for (const CloudArray array : columns_)
    offsets_.push_back(array == &PointCloud::x   ? sink.offset.x()
                       : array == &PointCloud::y ? sink.offset.y()
                       : array == &PointCloud::z ? sink.offset.z()
                                                 : 0.0);
  begin_part();
}

void CloudTable::begin_part() {
  part_ = std::min(left_, kPartPoints);
  point_ = 0;
  cloud_ = PointCloud();
  targets_.clear();
  for (const CloudArray array : columns_) {
    if (array != nullptr) (cloud_.*array).resize(part_);
    targets_.push_back(array != nullptr ? (cloud_.*array).data() : nullptr);
  }
}

void CloudTable::hand_on() {
  if (point_ == 0) return;
  for (const CloudArray array : columns_)
    if (array != nullptr) (cloud_.*array).resize(point_);
  if (cloud_.nx.empty() || cloud_.ny.empty() || cloud_.nz.empty()) {
    cloud_.nx.clear();
    cloud_.ny.clear();
    cloud_.nz.clear();
  }
  left_ -= point_;
  sink_.take(std::move(cloud_));
  begin_part();
}

std::string missing_coordinate(const std::vector<CloudArray>& columns) {
  for (const KnownColumn& known : {kKnownColumns[0], kKnownColumns[1], kKnownColumns[2]}) {
    if (std::find(columns.begin(), columns.end(), known.array) == columns.end())
      return std::string(known.name);
  }
  return "";
}

std::vector<NamedArray> columns_of(const PointCloud& cloud, const char* normal_x, const char* normal_y,
                                   const char* normal_z) {
  std::vector<NamedArray> columns = {{"x", &cloud.x}, {"y", &cloud.y}, {"z", &cloud.z}};
  if (cloud.has_normals())
    columns.insert(columns.end(), {{normal_x, &cloud.nx}, {normal_y, &cloud.ny}, {normal_z, &cloud.nz}});
  if (cloud.has_intensity()) columns.push_back({"intensity", &cloud.intensity});
  if (cloud.has_times()) columns.push_back({"time", &cloud.time});
  return columns;
}

void append_rows(std::string& bytes, const std::vector<NamedArray>& columns) {
  const std::size_t points = columns.front().values->size();
  bytes.reserve(bytes.size() + points * columns.size() * sizeof(float));
  for (std::size_t i = 0; i < points; ++i) {
    for (const NamedArray& column : columns) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &(*column.values)[i], sizeof bits);
      for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((bits >> shift) & 0xff);
    }
  }
}

void fail_at_byte(const std::string& path, std::size_t offset, const std::string& what) {
  throw std::runtime_error(path + ": byte " + std::to_string(offset) + ": " + what);
}

}  // namespace scanlock
