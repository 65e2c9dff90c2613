// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/packed_cloud.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "messages/point_times.hpp"

namespace scanlock {
namespace {

constexpr bool host_is_big_endian() {
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return true;
#else
  return false;
#endif
}

template <typename Value, bool kSwap>
Value load(const std::uint8_t* bytes) {
  Value value;
  if constexpr (kSwap) {
    std::array<std::uint8_t, sizeof(Value)> reversed;
    for (std::size_t i = 0; i < sizeof(Value); ++i) reversed[i] = bytes[sizeof(Value) - 1 - i];
    std::memcpy(&value, reversed.data(), sizeof value);
  } else {
    std::memcpy(&value, bytes, sizeof value);
  }
  return value;
}

template <typename Value>
Value load(const std::uint8_t* bytes, bool swap) {
  return swap ? load<Value, true>(bytes) : load<Value, false>(bytes);
}

/// Bytes from the start of the data to each point that is kept.
using Offsets = std::vector<std::uint32_t>;

/// Writes the finite points of the cloud to `points` without gaps, and their offsets in the data to
/// `offsets`. The arrays must have room for all points. Returns the number of points kept.
template <typename Coordinate, bool kSwap>
std::size_t unpack_points(const PackedCloud& cloud, PointCloud& points, Offsets& offsets) {
  const std::uint8_t* const data = cloud.data.data;
  const auto width = static_cast<std::size_t>(cloud.width), step = static_cast<std::size_t>(cloud.point_step);
  const auto x_at = static_cast<std::size_t>(cloud.x->offset),
             y_at = static_cast<std::size_t>(cloud.y->offset),
             z_at = static_cast<std::size_t>(cloud.z->offset);
  std::size_t kept = 0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(cloud.height); ++row) {
    std::size_t at = row * static_cast<std::size_t>(cloud.row_step);
    for (std::size_t column = 0; column < width; ++column, at += step) {
      const auto x = static_cast<float>(load<Coordinate, kSwap>(data + at + x_at));
      const auto y = static_cast<float>(load<Coordinate, kSwap>(data + at + y_at));
      const auto z = static_cast<float>(load<Coordinate, kSwap>(data + at + z_at));
      points.x[kept] = x;
      points.y[kept] = y;
      points.z[kept] = z;
      offsets[kept] = static_cast<std::uint32_t>(at);
      const bool finite_x = std::isfinite(x), finite_y = std::isfinite(y), finite_z = std::isfinite(z);
      const bool finite = finite_x & finite_y & finite_z;
      const bool origin = (x == 0) & (y == 0) & (z == 0);
      kept += finite & !origin;  // the next point overwrites a point not kept: no branch to mispredict
    }
  }
  return kept;
}

template <typename Value, typename Out>
void gather(const PackedCloud& cloud, const PackedField& field, bool swap, const Offsets& offsets,
            std::vector<Out>& values) {
  const std::uint8_t* const data = cloud.data.data + field.offset;
  values.resize(offsets.size());
  for (std::size_t i = 0; i < offsets.size(); ++i)
    values[i] = static_cast<Out>(load<Value>(data + offsets[i], swap));
}

template <typename Out>
void gather_any(const PackedCloud& cloud, const PackedField& field, bool swap, const Offsets& offsets,
                std::vector<Out>& values) {
  switch (field.datatype) {
    case 1:
      return gather<std::int8_t>(cloud, field, swap, offsets, values);
    case 2:
      return gather<std::uint8_t>(cloud, field, swap, offsets, values);
    case 3:
      return gather<std::int16_t>(cloud, field, swap, offsets, values);
    case 4:
      return gather<std::uint16_t>(cloud, field, swap, offsets, values);
    case 5:
      return gather<std::int32_t>(cloud, field, swap, offsets, values);
    case 6:
      return gather<std::uint32_t>(cloud, field, swap, offsets, values);
    case kFloat32Datatype:
      return gather<float>(cloud, field, swap, offsets, values);
    case kFloat64Datatype:
      return gather<double>(cloud, field, swap, offsets, values);
    default:
      values.clear();
  }
}

void fail_size(ByteReader& reader, const std::string& sentence) {
  reader.fail(DecodeFault::kBadSize, sentence);
}

/// True when the field is missing or lies within the point; otherwise a fault.
bool field_fits(const std::optional<PackedField>& field, std::int64_t point_step, ByteReader& reader) {
  if (!field) return true;
  const auto bytes = static_cast<std::int64_t>(datatype_size(field->datatype));
  if (bytes == 0) {
    reader.fail(DecodeFault::kBadField,
                "field `" + field->name + "` has the unknown datatype " + std::to_string(field->datatype));
  } else if (field->offset < 0 || field->offset > point_step - bytes) {
    reader.fail(DecodeFault::kBadField, "field `" + field->name + "` lies outside the point: offset " +
                                            std::to_string(field->offset) + " and " + std::to_string(bytes) +
                                            " bytes in a point_step of " + std::to_string(point_step));
  }
  return reader.ok();
}

/// Checks the sizes in 64 bits without overflow: each factor is below 2^31 when two are multiplied.
bool check_sizes(PackedCloud& cloud, const DecodeLimits& limits, ByteReader& reader) {
  const auto max_points = static_cast<std::int64_t>(limits.max_points);
  const auto bytes = static_cast<std::int64_t>(cloud.data.size);
  if (cloud.width < 0 || cloud.height < 0) {
    fail_size(reader, "`width` or `height` is negative: " + std::to_string(cloud.width) + " x " +
                          std::to_string(cloud.height));
  } else if (cloud.height > 0 && cloud.width > max_points / cloud.height) {
    fail_size(reader, "`width` x `height` is " + std::to_string(cloud.width) + " x " +
                          std::to_string(cloud.height) + ", over the limit of " + std::to_string(max_points) +
                          " points");
  } else if (cloud.width * cloud.height == 0) {
    if (bytes > 0)
      fail_size(reader, "`width` x `height` is 0, and there are " + std::to_string(bytes) + " data bytes");
  } else if (cloud.point_step <= 0 || cloud.point_step > bytes) {
    fail_size(reader, "`point_step` is " + std::to_string(cloud.point_step) + " with " +
                          std::to_string(bytes) + " data bytes");
  } else {
    const std::int64_t packed_row = cloud.width * cloud.point_step;
    if (cloud.row_step == 0 || cloud.height == 1) cloud.row_step = packed_row;  // often left unset
    if (cloud.row_step < packed_row || cloud.row_step > bytes) {
      fail_size(reader, "`row_step` is " + std::to_string(cloud.row_step) +
                            ", and a row of `width` x `point_step` takes " + std::to_string(packed_row) +
                            " of " + std::to_string(bytes) + " data bytes");
      return false;
    }
    const std::int64_t needed = (cloud.height - 1) * cloud.row_step + packed_row;
    const std::int64_t most = cloud.height * cloud.row_step + cloud.point_step - 1;
    if (needed > bytes || bytes > most)
      fail_size(reader, std::to_string(bytes) + " data bytes do not fit `height` x `row_step`, " +
                            std::to_string(cloud.height) + " x " + std::to_string(cloud.row_step));
  }
  return reader.ok();
}

bool check_fields(const PackedCloud& cloud, ByteReader& reader) {
  const auto coordinate = [&](const std::optional<PackedField>& field, const char* name) {
    if (!field) {
      reader.fail(DecodeFault::kBadField, std::string("there is no field `") + name + "` among " +
                                              (cloud.names.empty() ? "none" : cloud.names));
    } else if (field->datatype != kFloat32Datatype && field->datatype != kFloat64Datatype) {
      reader.fail(DecodeFault::kBadField, std::string("field `") + name + "` has datatype " +
                                              std::to_string(field->datatype) +
                                              "; 7 (float32) or 8 (float64) is read");
    }
    return field_fits(field, cloud.point_step, reader);
  };
  if (!coordinate(cloud.x, "x") || !coordinate(cloud.y, "y") || !coordinate(cloud.z, "z")) return false;
  if (cloud.x->datatype != cloud.y->datatype || cloud.x->datatype != cloud.z->datatype) {
    reader.fail(DecodeFault::kBadField, "fields `x`, `y` and `z` are of different types");
    return false;
  }
  return field_fits(cloud.intensity, cloud.point_step, reader) &&
         field_fits(cloud.time, cloud.point_step, reader);
}

std::string unpack_times(const PackedCloud& cloud, bool swap, const Offsets& offsets, Scan& scan) {
  if (!cloud.time)
    return "no time field (as `time`, float32 in s, or `t`, uint32 in ns) among " + cloud.names;
  TimeKind kind = TimeKind::kInteger;
  if (cloud.time->datatype == kFloat32Datatype) kind = TimeKind::kFloat32;
  if (cloud.time->datatype == kFloat64Datatype) kind = TimeKind::kFloat64;
  if (cloud.time->datatype < 5)
    return "`" + cloud.time->name + "` is ignored: an integer of less than 32 bits";
  std::vector<double> raw;
  gather_any(cloud, *cloud.time, swap, offsets, raw);
  return interpret_times(cloud.time->name, kind, scan.utime, raw, scan.points.time);
}

int intensity_name_rank(std::string_view name) {
  constexpr std::array<std::string_view, 5> kNames = {"intensity", "i", "reflectivity", "reflectance",
                                                      "remission"};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i]) return static_cast<int>(i);
  return -1;
}

}  // namespace

std::size_t datatype_size(int datatype) {
  constexpr std::array<std::size_t, 9> kSizes = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return datatype < 1 || datatype > 8 ? 0 : kSizes[static_cast<std::size_t>(datatype)];
}

void PackedCloud::consider_field(std::string_view name, std::int64_t offset, int datatype) {
  constexpr std::size_t kEnoughNames = 100;  // characters
  if (names.size() < kEnoughNames)
    names.append(names.empty() ? "`" : ", `").append(name.substr(0, 32)) += '`';
  const auto take = [&](std::optional<PackedField>& field, int rank) {
    if (!field || rank < field->rank) field = PackedField{std::string(name), offset, datatype, rank};
  };
  if (name == "x") return take(x, 0);
  if (name == "y") return take(y, 0);
  if (name == "z") return take(z, 0);
  if (const int rank = intensity_name_rank(name); rank >= 0) return take(intensity, rank);
  if (const std::optional<int> rank = time_name_rank(name)) take(time, *rank);
}

void unpack(const PackedCloud& given, const DecodeLimits& limits, ByteReader& reader, DecodedScan& decoded) {
  PackedCloud cloud = given;
  if (!reader.ok() || !check_sizes(cloud, limits, reader)) return;
  const auto total = static_cast<std::size_t>(cloud.width * cloud.height);
  if (total == 0 || !check_fields(cloud, reader)) return;
  if (cloud.data.size > std::numeric_limits<std::uint32_t>::max())
    return fail_size(reader, "over 4 GB of data");

  PointCloud& points = decoded.scan.points;
  points.x.resize(total);
  points.y.resize(total);
  points.z.resize(total);
  Offsets offsets(total);
  const bool swap = cloud.big_endian != host_is_big_endian();
  const bool wide = cloud.x->datatype == kFloat64Datatype;
  const auto unpack_kind = wide ? (swap ? unpack_points<double, true> : unpack_points<double, false>)
                                : (swap ? unpack_points<float, true> : unpack_points<float, false>);
  const std::size_t kept = unpack_kind(cloud, points, offsets);
  points.x.resize(kept);
  points.y.resize(kept);
  points.z.resize(kept);
  offsets.resize(kept);
  decoded.nonfinite_points = total - kept;

  if (cloud.intensity) gather_any(cloud, *cloud.intensity, swap, offsets, points.intensity);
  for (float& value : points.intensity)
    if (!std::isfinite(value)) value = 0;
  decoded.time_field = unpack_times(cloud, swap, offsets, decoded.scan);
}

}  // namespace scanlock
