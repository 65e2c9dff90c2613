// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/cloud_columns.hpp"
#include "io/text_lines.hpp"

namespace scanlock {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;  ///< of the scalar, or of the entries of a list
  std::optional<ScalarType> count_type;    ///< set for a list only
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// The least number of bytes in a row: exact without lists; a list counts as empty.
  std::size_t minimal_row_size(bool ascii) const;
};

struct PlyHeader {
  enum class Format : std::int8_t { kAscii, kLittleEndian, kBigEndian };
  Format format = Format::kAscii;
  std::vector<PlyElement> elements;
};

/// Reads up to and including end_header; throws an error naming the line (TextLines::fail()).
PlyHeader read_ply_header(TextLines& lines);

}  // namespace scanlock
