// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/ply_header.hpp"

#include <algorithm>
#include <array>

namespace scanlock {
namespace {

struct TypeName {
  std::string_view old_name, name;
  ScalarType type;
};
constexpr std::array<TypeName, 8> kTypeNames = {{
    {"char", "int8", ScalarType::kInt8},
    {"uchar", "uint8", ScalarType::kUint8},
    {"short", "int16", ScalarType::kInt16},
    {"ushort", "uint16", ScalarType::kUint16},
    {"int", "int32", ScalarType::kInt32},
    {"uint", "uint32", ScalarType::kUint32},
    {"float", "float32", ScalarType::kFloat32},
    {"double", "float64", ScalarType::kFloat64},
}};

ScalarType parse_type(const TextLines& lines, std::string_view word) {
  for (const TypeName& known : kTypeNames)
    if (word == known.old_name || word == known.name) return known.type;
  lines.fail("unknown type " + quoted(word) + " of a property");
}

PlyHeader::Format parse_format(const TextLines& lines, const std::vector<std::string_view>& words) {
  if (words.size() >= 2) {
    if (words[1] == "ascii") return PlyHeader::Format::kAscii;
    if (words[1] == "binary_little_endian") return PlyHeader::Format::kLittleEndian;
    if (words[1] == "binary_big_endian") return PlyHeader::Format::kBigEndian;
  }
  lines.fail("unknown format; known are ascii, binary_little_endian and binary_big_endian");
}

PlyElement parse_element(const TextLines& lines, const std::vector<std::string_view>& words) {
  const auto count = words.size() == 3 ? parse_unsigned(words[2]) : std::nullopt;
  if (!count) lines.fail("an element needs a name and a count");
  PlyElement element;
  element.name = std::string(words[1]);
  element.count = *count;
  return element;
}

PlyProperty parse_property(const TextLines& lines, const std::vector<std::string_view>& words) {
  PlyProperty property;
  if (words.size() == 3) {
    property.type = parse_type(lines, words[1]);
    property.name = std::string(words[2]);
  } else if (words.size() == 5 && words[1] == "list") {
    property.count_type = parse_type(lines, words[2]);
    property.type = parse_type(lines, words[3]);
    property.name = std::string(words[4]);
    if (*property.count_type == ScalarType::kFloat32 || *property.count_type == ScalarType::kFloat64)
      lines.fail("a list cannot be counted in floats");
  } else {
    lines.fail("a property is `property TYPE NAME` or `property list TYPE TYPE NAME`");
  }
  return property;
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const auto& p) { return p.count_type.has_value(); });
}

std::size_t PlyElement::minimal_row_size(bool ascii) const {
  if (ascii) return properties.empty() ? 0 : 2 * properties.size() - 1;  // one character per word, and blanks
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += size_of(property.count_type.value_or(property.type));
  return size;
}

PlyHeader read_ply_header(TextLines& lines) {
  auto line = lines.next();
  if (!line || *line != "ply") lines.fail("not a PLY file: its first line is not `ply`");
  PlyHeader header;
  bool has_format = false;
  while ((line = lines.next())) {
    const auto words = split_words(*line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") {
      if (!has_format) lines.fail("the header has no `format`");
      return header;
    }
    if (words[0] == "format") {
      header.format = parse_format(lines, words);
      has_format = true;
    } else if (words[0] == "element") {
      header.elements.push_back(parse_element(lines, words));
    } else if (words[0] == "property") {
      if (header.elements.empty()) lines.fail("a property before the first element");
      header.elements.back().properties.push_back(parse_property(lines, words));
    } else {
      lines.fail("unknown word " + quoted(words[0]) + " in the header");
    }
  }
  lines.fail("the file ends before `end_header`");
}

}  // namespace scanlock
