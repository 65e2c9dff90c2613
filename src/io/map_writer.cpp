// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/map_writer.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/crc32.hpp"
#include "io/map_file.hpp"
#include "io/map_layout.hpp"

namespace scanlock {
namespace {

template <typename Unsigned>
void put(std::vector<std::uint8_t>& out, Unsigned value) {
  static_assert(std::is_unsigned_v<Unsigned>);
  for (std::size_t i = 0; i < sizeof value; ++i)
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
}

void put_pose(std::vector<std::uint8_t>& out, const Pose& pose) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) put(out, bits_of<std::uint64_t>(pose.matrix()(row, column)));
}

bool is_finite(const PointCloud& points, std::size_t i) {
  return points.point(i).allFinite();
}

/// The exponent of the smallest step with which all finite coordinates fit into 32767 steps.
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

/// The number of finite points. Points stored in a map file are all finite and are not read for this.
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
  put(out, static_cast<std::uint32_t>(keyframe.body_ups.size()));
  for (const Eigen::Vector3f& up : keyframe.body_ups)
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

}  // namespace

void encode_map(const SavedMap& map, const TakeBytes& take) {
  std::uint64_t body = 4 + kPoseBytes + kUpBytes + 4 + 4 + kConstraintBytes * map.constraints.size();
  for (const ArchivedKeyframe& keyframe : map.keyframes)
    body += kKeyframeBytes + kPointBytes * finite_points(keyframe.points) + 4 +
            kStandBytes * keyframe.body_ups.size();
  std::vector<std::uint8_t> piece(kMagic.begin(), kMagic.end());
  std::uint32_t checksum = 0;
  const auto flush = [&] {
    checksum = crc32(piece.data(), piece.size(), checksum);
    take(as_text(piece));
    piece.clear();
  };
  put(piece, kMapVersion);
  put(piece, body);
  put(piece, map.epoch);
  put_pose(piece, map.last_pose);
  for (const double coordinate : map.up) put(piece, bits_of<std::uint64_t>(coordinate));
  put(piece, static_cast<std::uint32_t>(map.keyframes.size()));
  for (const ArchivedKeyframe& keyframe : map.keyframes) {
    put_keyframe(piece, keyframe);
    flush();
  }
  put(piece, static_cast<std::uint32_t>(map.constraints.size()));
  for (const Constraint& constraint : map.constraints) put_constraint(piece, constraint);
  flush();
  put(piece, checksum);
  take(as_text(piece));
}

}  // namespace scanlock
