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
  ScalarType type = ScalarType::kFloat32;  ///< of the scalar, or of a list's entries
  std::optional<ScalarType> count_type;    ///< there for a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// The least bytes that one row takes: exact without lists, whose entries may be none.
  std::size_t minimal_row_size(bool ascii) const;
};

struct PlyHeader {
  enum class Format : std::int8_t { kAscii, kLittleEndian, kBigEndian };
  Format format = Format::kAscii;
  std::vector<PlyElement> elements;
};

/// Reads up to and including end_header; fails naming the line.
PlyHeader read_ply_header(TextLines& lines);

}  // namespace scanlock
