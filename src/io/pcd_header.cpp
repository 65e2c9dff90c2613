// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/pcd_header.hpp"

#include <limits>

namespace scanlock {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::size_t kMaxPointSize = 1u << 20;  // bytes; keeps sums of sizes from overflowing

std::size_t parse_count(const TextLines& lines, const Words& words, std::size_t index) {
  const auto value = index < words.size() ? parse_unsigned(words[index]) : std::nullopt;
  if (!value) lines.fail(std::string(words[0]) + " needs a whole number as value " + std::to_string(index));
  return *value;
}

/// Sets one member of every field from a header line that has one word per field.
template <typename Set>
void for_each_field(const TextLines& lines, const Words& words, PcdHeader& header, Set set) {
  if (header.fields.empty()) lines.fail(std::string(words[0]) + " comes before FIELDS");
  if (words.size() != header.fields.size() + 1)
    lines.fail(std::string(words[0]) + " has " + std::to_string(words.size() - 1) + " entries for " +
               std::to_string(header.fields.size()) + " fields");
  for (std::size_t i = 0; i < header.fields.size(); ++i) set(header.fields[i], i + 1);
}

std::size_t parse_bounded(const TextLines& lines, const Words& words, std::size_t index) {
  const std::size_t value = parse_count(lines, words, index);
  if (value > kMaxPointSize)
    lines.fail(std::string(words[0]) + " " + std::to_string(value) + " is out of range");
  return value;
}

PcdHeader::Data parse_data(const TextLines& lines, const Words& words) {
  const std::string_view kind = words.size() == 2 ? words[1] : std::string_view();
  if (kind == "ascii") return PcdHeader::Data::kAscii;
  if (kind == "binary") return PcdHeader::Data::kBinary;
  if (kind == "binary_compressed") return PcdHeader::Data::kCompressed;
  lines.fail("unknown DATA; known are ascii, binary and binary_compressed");
}

/// Computes the offset of each field within a point.
void lay_out(const TextLines& lines, PcdHeader& header) {
  for (PcdField& field : header.fields) {
    field.offset = header.point_size;
    field.word = header.point_words;
    header.point_size += field.size * field.count;
    header.point_words += field.count;
    if (header.point_size > kMaxPointSize || header.point_words > kMaxPointSize)
      lines.fail("a point of more than a megabyte");
  }
  if (header.point_size == 0) lines.fail("the header names no FIELDS with a SIZE");
}

}  // namespace

PcdHeader read_pcd_header(TextLines& lines) {
  PcdHeader header;
  std::optional<std::size_t> width, height, points;
  while (const auto line = lines.next_with_content()) {
    const Words words = split_words(*line);
    const std::string_view key = words[0];
    if (key == "VERSION" || key == "VIEWPOINT") {
      continue;
    } else if (key == "FIELDS" || key == "COLUMNS") {
      header.fields.clear();
      for (std::size_t i = 1; i < words.size(); ++i) header.fields.push_back({std::string(words[i])});
    } else if (key == "SIZE") {
      for_each_field(lines, words, header,
                     [&](PcdField& f, std::size_t i) { f.size = parse_bounded(lines, words, i); });
    } else if (key == "TYPE") {
      for_each_field(lines, words, header, [&](PcdField& f, std::size_t i) { f.type = words[i][0]; });
    } else if (key == "COUNT") {
      for_each_field(lines, words, header,
                     [&](PcdField& f, std::size_t i) { f.count = parse_bounded(lines, words, i); });
    } else if (key == "WIDTH") {
      width = parse_count(lines, words, 1);
    } else if (key == "HEIGHT") {
      height = parse_count(lines, words, 1);
    } else if (key == "POINTS") {
      points = parse_count(lines, words, 1);
    } else if (key == "DATA") {
      header.data = parse_data(lines, words);
      if (!points && width) {
        const std::size_t rows = height.value_or(1);
        if (rows != 0 && *width > std::numeric_limits<std::size_t>::max() / rows)
          lines.fail("WIDTH x HEIGHT overflows");
        points = *width * rows;
      }
      if (!points) lines.fail("the header names neither POINTS nor WIDTH");
      header.points = *points;
      lay_out(lines, header);
      return header;
    } else {
      lines.fail(quoted(key) + " is no line of a PCD header: not a PCD file, or damaged");
    }
  }
  lines.fail("the file ends before its DATA line");
}

std::optional<ScalarType> scalar_type(const PcdField& field) {
  const auto is = [&](char type, std::size_t size) { return field.type == type && field.size == size; };
  if (is('F', 4)) return ScalarType::kFloat32;
  if (is('F', 8)) return ScalarType::kFloat64;
  if (is('I', 1)) return ScalarType::kInt8;
  if (is('I', 2)) return ScalarType::kInt16;
  if (is('I', 4)) return ScalarType::kInt32;
  if (is('I', 8)) return ScalarType::kInt64;
  if (is('U', 1)) return ScalarType::kUint8;
  if (is('U', 2)) return ScalarType::kUint16;
  if (is('U', 4)) return ScalarType::kUint32;
  if (is('U', 8)) return ScalarType::kUint64;
  return std::nullopt;
}

}  // namespace scanlock
