// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/map_reader.hpp"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/linear.hpp"
#include "io/crc32.hpp"
#include "io/map_file.hpp"
#include "io/map_layout.hpp"
#include "io/points_in_file.hpp"

namespace scanlock {
namespace {

/// Reads numbers from bytes and computes their checksum. A read past the end throws an error that names the
/// offset and the item that was to be read.
class MapReader {
 public:
  MapReader(ByteSource& source, std::string name) : source_(source), name_(std::move(name)) {}

  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    throw std::runtime_error(name_ + ": byte " + std::to_string(at) + ": " + what);
  }
  void need(std::uint64_t count, const char* what) const {
    if (count > left()) {
      fail(at(), std::string(what) + " would take " + std::to_string(count) + " bytes, " +
                     std::to_string(left()) + " are left");
    }
  }
  template <typename Unsigned>
  Unsigned get(const char* what) {
    need(sizeof(Unsigned), what);
    const std::uint8_t* bytes = as_bytes(source_.peek(sizeof(Unsigned)));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
      value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    pass(sizeof(Unsigned));
    return static_cast<Unsigned>(value);
  }
  /// The points of a keyframe; if the source is a file, they are not loaded but stay in it.
  KeyframePoints points(std::uint64_t count, int exponent) {
    need(count * kPointBytes, "the points");
    PointsInFile::Part part;
    part.count = static_cast<std::size_t>(count);
    part.exponent = exponent;
    part.offset = at();
    part.before = checksum_;
    const std::size_t size = part.count * kPointBytes;
    if (!source_.file()) {
      PointCloud cloud = decoded_points(source_.peek(size).substr(0, size), exponent);
      pass(size);
      return cloud;
    }
    pass(size);
    part.after = checksum_;
    return KeyframePoints(std::make_shared<const PointsInFile>(source_.file(), part));
  }
  /// Excludes the checksum at the end of the file from left(), until check_sum().
  void hold_back_checksum() { held_back_ = kChecksumBytes; }
  /// Skips the bytes that are left, then compares the checksum.
  void check_sum() {
    pass(left());
    held_back_ = 0;
    const std::size_t end = at();
    const std::uint32_t sum = checksum_;
    if (get<std::uint32_t>("the checksum") != sum)
      fail(end, "the checksum does not match: the file is damaged");
  }
  std::size_t at() const { return source_.offset(); }
  std::size_t left() const { return source_.left() - held_back_; }

 private:
  void pass(std::size_t count) {
    while (count > 0) {
      const std::string_view piece = source_.peek(1).substr(0, count);
      checksum_ = crc32(as_bytes(piece), piece.size(), checksum_);
      source_.skip(piece.size());
      count -= piece.size();
    }
  }

  ByteSource& source_;
  std::size_t held_back_ = 0;   ///< bytes at the end of the source that left() excludes
  std::uint32_t checksum_ = 0;  ///< of all bytes read so far
  std::string name_;
};

/// Reads the header and returns the version.
std::uint32_t read_header(MapReader& reader) {
  for (const std::uint8_t expected : kMagic) {
    const std::size_t at = reader.at();
    if (reader.left() == 0 || reader.get<std::uint8_t>("the signature of a map file") != expected)
      reader.fail(at, "not a scanlock map");
  }
  const std::size_t at = reader.at();
  const auto version = reader.get<std::uint32_t>("the version");
  if (version < 1 || version > kMapVersion) {
    reader.fail(at, "version " + std::to_string(version) +
                        " of the map file; this program reads versions 1 to " + std::to_string(kMapVersion) +
                        (version > kMapVersion ? ", a newer one is needed" : ""));
  }
  const auto body = reader.get<std::uint64_t>("the size of the body");
  const std::size_t there = reader.left();
  if (there < kChecksumBytes || body != there - kChecksumBytes) {
    reader.fail(at + 4, "a body of " + std::to_string(body) + " bytes and a checksum of " +
                            std::to_string(kChecksumBytes) + " are announced, " + std::to_string(there) +
                            " bytes follow: the file is " +
                            (there < kChecksumBytes || body > there - kChecksumBytes ? "cut" : "too long"));
  }
  reader.hold_back_checksum();
  return version;
}

Pose read_pose(MapReader& reader, const char* what) {
  const std::size_t at = reader.at();
  reader.need(kPoseBytes, what);
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      pose.matrix()(row, column) = bits_of<double>(reader.get<std::uint64_t>(what));
  const Eigen::Matrix3d rotation = pose.linear();
  constexpr double kTolerance = 1e-6;
  const bool good = pose.matrix().allFinite() && rotation.determinant() > 0 &&
                    (rotation * rotation.transpose()).isApprox(Eigen::Matrix3d::Identity(), kTolerance);
  if (!good) reader.fail(at, std::string(what) + " is no rigid pose");
  return pose;
}

Eigen::Vector3d read_up(MapReader& reader) {
  const std::size_t at = reader.at();
  reader.need(kUpBytes, "the upward direction");
  Eigen::Vector3d up;
  for (double& coordinate : up)
    coordinate = bits_of<double>(reader.get<std::uint64_t>("the upward direction"));
  constexpr double kTolerance = 1e-6;
  if (!(std::abs(up.norm() - 1) < kTolerance)) reader.fail(at, "the upward direction is not a unit vector");
  return up;
}

std::vector<Eigen::Vector3f> read_stands(MapReader& reader) {
  const std::size_t start = reader.at();
  const std::uint64_t count = reader.get<std::uint32_t>("the number of body-up attitudes");
  if (count > kMostBodyUps)
    reader.fail(start, std::to_string(count) + " body-up attitudes of a keyframe, over the limit of " +
                           std::to_string(kMostBodyUps));
  reader.need(count * kStandBytes, "the body-up attitudes");
  std::vector<Eigen::Vector3f> body_ups(static_cast<std::size_t>(count));
  for (Eigen::Vector3f& up : body_ups) {
    const std::size_t at = reader.at();
    for (int axis = 0; axis < 3; ++axis)
      up[axis] = bits_of<float>(reader.get<std::uint32_t>("a body-up attitude"));
    constexpr float kTolerance = 1e-3F;
    if (!(std::abs(up.norm() - 1) < kTolerance)) reader.fail(at, "a body-up attitude is not a unit vector");
  }
  return body_ups;
}

ArchivedKeyframe read_keyframe(MapReader& reader, std::uint32_t version) {
  ArchivedKeyframe keyframe;
  reader.need(kKeyframeBytes, "a keyframe");
  keyframe.utime = bits_of<std::int64_t>(reader.get<std::uint64_t>("a time"));
  keyframe.map_from_body = read_pose(reader, "the pose of a keyframe");
  std::size_t at = reader.at();
  keyframe.reach = bits_of<float>(reader.get<std::uint32_t>("a reach"));
  if (!(std::isfinite(keyframe.reach) && keyframe.reach >= 0))
    reader.fail(at, "the reach of a keyframe is not a length");
  at = reader.at();
  const int exponent = bits_of<std::int32_t>(reader.get<std::uint32_t>("a step"));
  if (exponent < kFinestStep || exponent > kCoarsestStep)
    reader.fail(at, "a step of 2^" + std::to_string(exponent) + " m is out of range");
  const std::uint64_t count = reader.get<std::uint32_t>("the number of points");
  keyframe.points = reader.points(count, exponent);
  if (version >= 2) keyframe.body_ups = read_stands(reader);
  return keyframe;
}

/// Whether the matrix is positive semidefinite within rounding.
bool is_information(const Matrix6& information) {
  if (!information.allFinite()) return false;
  const Vector6 values = symmetric_eigen(information).values;
  constexpr double kRounding = 1e-9;
  return values[0] >= -kRounding * values[5];
}

Constraint read_constraint(MapReader& reader, std::uint64_t keyframes) {
  Constraint constraint;
  const std::size_t start = reader.at();
  constraint.from = reader.get<std::uint32_t>("a constraint");
  constraint.to = reader.get<std::uint32_t>("a constraint");
  if (constraint.from > keyframes || constraint.to > keyframes || constraint.from == constraint.to) {
    reader.fail(start, "a constraint between keyframes " + std::to_string(constraint.from) + " and " +
                           std::to_string(constraint.to) + " of " + std::to_string(keyframes));
  }
  constraint.from_to = read_pose(reader, "the pose of a constraint");
  std::size_t at = reader.at();
  const auto kind = reader.get<std::uint32_t>("the kind of a constraint");
  if (kind > 1) reader.fail(at, std::to_string(kind) + " is no kind of constraint");
  constraint.loop_closure = kind == 1;
  at = reader.at();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      const auto value = bits_of<double>(reader.get<std::uint64_t>("the information of a constraint"));
      constraint.information(row, column) = constraint.information(column, row) = value;
    }
  }
  if (!is_information(constraint.information))
    reader.fail(at, "the information matrix of a constraint is not positive semidefinite");
  return constraint;
}

SavedMap read_body(MapReader& reader, std::uint32_t version) {
  SavedMap map;
  map.epoch = reader.get<std::uint32_t>("the epoch");
  map.last_pose = read_pose(reader, "the last pose");
  if (version >= 4) map.up = read_up(reader);
  const std::uint64_t count = reader.get<std::uint32_t>("the number of keyframes");
  reader.need(count * kKeyframeBytes, "the keyframes");
  map.keyframes.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) map.keyframes.push_back(read_keyframe(reader, version));
  if (version >= 3) {
    const std::uint64_t constraints = reader.get<std::uint32_t>("the number of constraints");
    reader.need(constraints * kConstraintBytes, "the constraints");
    map.constraints.reserve(static_cast<std::size_t>(constraints));
    for (std::uint64_t i = 0; i < constraints; ++i) map.constraints.push_back(read_constraint(reader, count));
  }
  if (reader.left() > 0)
    reader.fail(reader.at(), std::to_string(reader.left()) + " bytes follow the end of the map");
  return map;
}

}  // namespace

SavedMap decode_map(ByteSource& source, const std::string& name) {
  MapReader reader(source, name);
  const std::uint32_t version = read_header(reader);
  SavedMap map;
  try {
    map = read_body(reader, version);
  } catch (const std::runtime_error&) {
    reader.check_sum();
    throw;
  }
  reader.check_sum();
  return map;
}

}  // namespace scanlock
