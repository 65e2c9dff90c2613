// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/cloud_columns.hpp"
#include "io/text_lines.hpp"

namespace scanlock {

struct PcdField {
  std::string name;
  std::size_t size = 4;    ///< bytes of one value
  char type = 'F';         ///< I, U or F
  std::size_t count = 1;   ///< values per point
  std::size_t offset = 0;  ///< bytes from the start of the point
  std::size_t word = 0;    ///< index of its first value among the words of an ascii line
};

struct PcdHeader {
  enum class Data : std::int8_t { kAscii, kBinary, kCompressed };
  std::vector<PcdField> fields;
  std::size_t points = 0;
  std::size_t point_size = 0;   ///< bytes
  std::size_t point_words = 0;  ///< numbers per ascii line
  Data data = Data::kAscii;
};

/// Reads up to and including the DATA line; throws an error naming the line (TextLines::fail()).
PcdHeader read_pcd_header(TextLines& lines);

/// The scalar type of a field, or nothing for a combination of TYPE and SIZE that PCD does not define (the
/// field is then skipped).
std::optional<ScalarType> scalar_type(const PcdField& field);

}  // namespace scanlock
