// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/map_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include "geometry/linear.hpp"
#include "io/atomic_file.hpp"
#include "io/byte_source.hpp"
#include "io/crc32.hpp"

namespace scanlock {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'S', 'L', 'M', 'A', 'P', '\r', '\n'};
constexpr std::size_t kHeaderBytes = 20, kChecksumBytes = 4;
constexpr std::size_t kPoseBytes = 12 * 8, kKeyframeBytes = 8 + kPoseBytes + 4 + 4 + 4;  // without its points
constexpr std::size_t kConstraintBytes = 4 + 4 + kPoseBytes + 4 + 21 * 8;
constexpr std::size_t kPointBytes = 3 * 2, kStandBytes = 3 * 4;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 32;  // a cloud of 1e8 points takes up to 1.2 GB
constexpr int kFinestStep = -24, kCoarsestStep = 24;            // metres, as powers of two
constexpr double kMostSteps = 32767;

template <typename Unsigned>
void put(std::vector<std::uint8_t>& out, Unsigned value) {
  static_assert(std::is_unsigned_v<Unsigned>);
  for (std::size_t i = 0; i < sizeof value; ++i)
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
}

/// The same bits as a number without sign.
template <typename Unsigned, typename Value>
Unsigned bits_of(Value value) {
  static_assert(sizeof(Unsigned) == sizeof(Value));
  Unsigned bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

void put_pose(std::vector<std::uint8_t>& out, const Pose& pose) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) put(out, bits_of<std::uint64_t>(pose.matrix()(row, column)));
}

bool is_finite(const PointCloud& points, std::size_t i) {
  return points.point(i).allFinite();
}

/// The exponent of the smallest step that reaches all finite coordinates.
int step_exponent(const PointCloud& points) {
  float farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_finite(points, i)) farthest = std::max(farthest, points.point(i).cwiseAbs().maxCoeff());
  int exponent = kFinestStep;
  while (exponent < kCoarsestStep &&
         std::lround(std::ldexp(static_cast<double>(farthest), -exponent)) > static_cast<long>(kMostSteps))
    ++exponent;
  return exponent;
}

/// Those of a map file all are, and are not read for it.
std::size_t finite_points(const KeyframePoints& points) {
  if (points.are_stored()) return points.size();
  const std::shared_ptr<const PointCloud> cloud = points.cloud();
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud->size(); ++i) count += is_finite(*cloud, i) ? 1 : 0;
  return count;
}

void put_keyframe(std::vector<std::uint8_t>& out, const ArchivedKeyframe& keyframe) {
  const std::shared_ptr<const PointCloud> cloud = keyframe.points.cloud();
  const PointCloud& points = *cloud;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_finite(points, i)) kept.push_back(i);
  const int exponent = step_exponent(points);
  put(out, bits_of<std::uint64_t>(keyframe.utime));
  put_pose(out, keyframe.map_from_body);
  put(out, bits_of<std::uint32_t>(keyframe.reach));
  put(out, bits_of<std::uint32_t>(exponent));
  put(out, static_cast<std::uint32_t>(kept.size()));
  const double steps_a_metre = std::ldexp(1.0, -exponent);  // a power of two: the product is exact
  for (const auto* axis : {&points.x, &points.y, &points.z}) {
    for (const std::size_t i : kept) {
      const double steps = std::round(static_cast<double>((*axis)[i]) * steps_a_metre);
      put(out, bits_of<std::uint16_t>(static_cast<std::int16_t>(std::clamp(steps, -kMostSteps, kMostSteps))));
    }
  }
  put(out, static_cast<std::uint32_t>(keyframe.stands.size()));
  for (const Eigen::Vector3f& up : keyframe.stands)
    for (const float coordinate : {up.x(), up.y(), up.z()}) put(out, bits_of<std::uint32_t>(coordinate));
}

void put_constraint(std::vector<std::uint8_t>& out, const Constraint& constraint) {
  put(out, constraint.from);
  put(out, constraint.to);
  put_pose(out, constraint.from_to);
  put(out, std::uint32_t{constraint.loop_closure});
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      put(out, bits_of<std::uint64_t>(constraint.information(row, column)));
}

std::string_view view(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

const std::uint8_t* data(std::string_view bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

/// Coordinates as steps of 2^exponent metres: all x, then all y, then all z.
PointCloud decoded_points(std::string_view bytes, int exponent) {
  PointCloud points;
  const std::size_t count = bytes.size() / kPointBytes;
  const auto step = static_cast<float>(std::ldexp(1.0, exponent));
  const std::uint8_t* at = data(bytes);
  for (auto* axis : {&points.x, &points.y, &points.z}) {
    axis->resize(count);
    for (float& coordinate : *axis) {
      const auto steps = bits_of<std::int16_t>(static_cast<std::uint16_t>(at[0] | at[1] << 8));
      coordinate = step * static_cast<float>(steps);  // exact
      at += 2;
    }
  }
  return points;
}

/// The points of a keyframe in a map file.
class PointsInFile : public StoredPoints {
 public:
  struct Part {
    std::size_t offset = 0, count = 0;    ///< bytes, points
    int exponent = 0;                     ///< of the step
    std::uint32_t before = 0, after = 0;  ///< checksums of the file up to its begin and up to its end
  };
  PointsInFile(std::shared_ptr<const InputFile> file, const Part& part)
      : file_(std::move(file)), part_(part) {}

  std::size_t size() const override { return part_.count; }
  /// A file may be written over while it is open: what is there now need not be what was loaded.
  PointCloud read() const override {
    std::vector<std::uint8_t> bytes(part_.count * kPointBytes);
    try {
      file_->read(part_.offset, bytes.size(), bytes.data());
    } catch (const std::runtime_error& error) {
      throw PointsUnreadable(error.what() + std::string(kToDo));
    }
    if (crc32(bytes.data(), bytes.size(), part_.before) != part_.after)
      throw PointsUnreadable(file_->path() + ": was changed in place" + kToDo);
    return decoded_points(view(bytes), part_.exponent);
  }

 private:
  static constexpr const char* kToDo =
      "; the map that was loaded from it has lost points: load a map again, and replace map files with mv";
  const std::shared_ptr<const InputFile> file_;
  const Part part_;
};

/// Reads numbers off bytes, and their checksum; whoever asks for more than there is gets an error that says
/// where and for what.
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
    const std::uint8_t* bytes = data(source_.peek(sizeof(Unsigned)));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
      value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    pass(sizeof(Unsigned));
    return static_cast<Unsigned>(value);
  }
  /// Points of a file stay there.
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
  /// Leaves the checksum at the end to check_sum().
  void hold_back_checksum() { held_back_ = kChecksumBytes; }
  /// Passes over what is left.
  void check_sum() {
    pass(left());
    held_back_ = 0;
    const std::size_t end = at();
    const std::uint32_t sum = checksum_;
    if (get<std::uint32_t>("the checksum") != sum)
      fail(end, "the checksum does not fit: the file is damaged");
  }
  std::size_t at() const { return source_.offset(); }
  std::size_t left() const { return source_.left() - held_back_; }

 private:
  void pass(std::size_t count) {
    while (count > 0) {
      const std::string_view piece = source_.peek(1).substr(0, count);
      checksum_ = crc32(data(piece), piece.size(), checksum_);
      source_.skip(piece.size());
      count -= piece.size();
    }
  }

  ByteSource& source_;
  std::size_t held_back_ = 0;   ///< bytes at the end that are not for reading
  std::uint32_t checksum_ = 0;  ///< of all that was read
  std::string name_;
};

/// Returns the version.
std::uint32_t read_header(MapReader& reader) {
  for (const std::uint8_t expected : kMagic) {
    const std::size_t at = reader.at();
    if (reader.left() == 0 || reader.get<std::uint8_t>("the mark of a map file") != expected)
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
                            " are there: the file is " +
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

std::vector<Eigen::Vector3f> read_stands(MapReader& reader) {
  const std::size_t start = reader.at();
  const std::uint64_t count = reader.get<std::uint32_t>("the number of stands");
  if (count > kMostStands) reader.fail(start, std::to_string(count) + " stands are none of ours");
  reader.need(count * kStandBytes, "the stands");
  std::vector<Eigen::Vector3f> stands(static_cast<std::size_t>(count));
  for (Eigen::Vector3f& up : stands) {
    const std::size_t at = reader.at();
    for (int axis = 0; axis < 3; ++axis) up[axis] = bits_of<float>(reader.get<std::uint32_t>("a stand"));
    constexpr float kTolerance = 1e-3F;
    if (!(std::abs(up.norm() - 1) < kTolerance)) reader.fail(at, "a stand is no direction");
  }
  return stands;
}

ArchivedKeyframe read_keyframe(MapReader& reader, std::uint32_t version) {
  ArchivedKeyframe keyframe;
  reader.need(kKeyframeBytes, "a keyframe");
  keyframe.utime = bits_of<std::int64_t>(reader.get<std::uint64_t>("a time"));
  keyframe.map_from_body = read_pose(reader, "the pose of a keyframe");
  std::size_t at = reader.at();
  keyframe.reach = bits_of<float>(reader.get<std::uint32_t>("a reach"));
  if (!(std::isfinite(keyframe.reach) && keyframe.reach >= 0)) reader.fail(at, "the reach is no length");
  at = reader.at();
  const int exponent = bits_of<std::int32_t>(reader.get<std::uint32_t>("a step"));
  if (exponent < kFinestStep || exponent > kCoarsestStep)
    reader.fail(at, "a step of 2^" + std::to_string(exponent) + " m is none of ours");
  const std::uint64_t count = reader.get<std::uint32_t>("the number of points");
  keyframe.points = reader.points(count, exponent);
  if (version >= 2) keyframe.stands = read_stands(reader);
  return keyframe;
}

/// Not negative in any direction, but for rounding.
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
    reader.fail(at, "the information of a constraint is no inverse of a covariance");
  return constraint;
}

SavedMap read_body(MapReader& reader, std::uint32_t version) {
  SavedMap map;
  map.epoch = reader.get<std::uint32_t>("the epoch");
  map.last_pose = read_pose(reader, "the last pose");
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
    reader.fail(reader.at(), std::to_string(reader.left()) + " bytes more than the map takes");
  return map;
}

/// In one pass. Of a damaged file the checksum is what is wrong, whatever else seems to be.
SavedMap decode(ByteSource& source, const std::string& name) {
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

/// Hands the bytes of a file over piece by piece.
void encode(const SavedMap& map, const TakeBytes& take) {
  std::uint64_t body = 4 + kPoseBytes + 4 + 4 + kConstraintBytes * map.constraints.size();
  for (const ArchivedKeyframe& keyframe : map.keyframes)
    body += kKeyframeBytes + kPointBytes * finite_points(keyframe.points) + 4 +
            kStandBytes * keyframe.stands.size();
  std::vector<std::uint8_t> piece(kMagic.begin(), kMagic.end());
  std::uint32_t checksum = 0;
  const auto flush = [&] {
    checksum = crc32(piece.data(), piece.size(), checksum);
    take(view(piece));
    piece.clear();
  };
  put(piece, kMapVersion);
  put(piece, body);
  put(piece, map.epoch);
  put_pose(piece, map.last_pose);
  put(piece, static_cast<std::uint32_t>(map.keyframes.size()));
  for (const ArchivedKeyframe& keyframe : map.keyframes) {
    put_keyframe(piece, keyframe);
    flush();
  }
  put(piece, static_cast<std::uint32_t>(map.constraints.size()));
  for (const Constraint& constraint : map.constraints) put_constraint(piece, constraint);
  flush();
  put(piece, checksum);
  take(view(piece));
}

/// Another file's name in a command must not cost that file.
void refuse_other_files(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || std::filesystem::file_size(path, error) == 0) return;
  std::ifstream file(path, std::ios::binary);
  std::array<char, kMagic.size()> start{};
  file.read(start.data(), start.size());
  if (!file || std::memcmp(start.data(), kMagic.data(), kMagic.size()) != 0)
    throw std::runtime_error(path + ": is there and is not a scanlock map; it is not overwritten");
}

}  // namespace

std::vector<std::uint8_t> encode_map(const SavedMap& map) {
  std::vector<std::uint8_t> bytes;
  encode(map, [&](std::string_view piece) { bytes.insert(bytes.end(), piece.begin(), piece.end()); });
  return bytes;
}

SavedMap decode_map(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  ByteSource source(bytes);
  return decode(source, name);
}

void write_map(const std::string& path, const SavedMap& map) {
  refuse_other_files(path);
  write_file_atomically(path, [&](const TakeBytes& take) { encode(map, take); });
}

SavedMap read_map(const std::string& path) {
  ByteSource source(path);
  if (source.left() > kMostBytes)
    throw std::runtime_error(path + ": has " + std::to_string(source.left()) +
                             " bytes; no scanlock map is so large");
  return decode(source, path);
}

}  // namespace scanlock
