// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/points_in_file.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/crc32.hpp"
#include "io/map_layout.hpp"

namespace scanlock {
namespace {

constexpr const char* kToDo =
    "; points of the loaded map cannot be read: load a map again, and replace map files only with mv";

}  // namespace

PointCloud decoded_points(std::string_view bytes, int exponent) {
  PointCloud points;
  const std::size_t count = bytes.size() / kPointBytes;
  const auto step = static_cast<float>(std::ldexp(1.0, exponent));
  const std::uint8_t* at = as_bytes(bytes);
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

PointCloud PointsInFile::read() const {
  std::vector<std::uint8_t> bytes(part_.count * kPointBytes);
  try {
    file_->read(part_.offset, bytes.size(), bytes.data());
  } catch (const std::runtime_error& error) {
    throw PointsUnreadable(error.what() + std::string(kToDo));
  }
  if (crc32(bytes.data(), bytes.size(), part_.before) != part_.after)
    throw PointsUnreadable(file_->path() + ": was changed in place" + kToDo);
  return decoded_points(as_text(bytes), part_.exponent);
}

}  // namespace scanlock
