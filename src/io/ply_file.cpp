// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <algorithm>

#include "io/cloud_columns.hpp"
#include "io/cloud_formats.hpp"
#include "io/ply_header.hpp"
#include "io/text_lines.hpp"

namespace scanlock {
namespace {

/// The target array of each property; null for lists and unknown properties.
std::vector<CloudArray> arrays_of(const PlyElement& element) {
  std::vector<CloudArray> arrays;
  for (const PlyProperty& property : element.properties)
    arrays.push_back(property.count_type ? nullptr : array_for(property.name, property.type));
  return arrays;
}

std::string too_short(const PlyElement& element, std::size_t bytes_left) {
  return "the header promises " + std::to_string(element.count) + " of element '" + element.name +
         "', more than the " + std::to_string(bytes_left) +
         " bytes that follow can hold: the file is cut short";
}

/// True when the bytes left are too few for `count` rows. Divides instead of multiplying, so that a forged
/// count cannot overflow.
bool cannot_hold(const PlyElement& element, bool ascii, std::size_t bytes_left) {
  const std::size_t row = element.minimal_row_size(ascii) + (ascii ? 1 : 0);
  const std::size_t missing_newline = ascii ? 1 : 0;  // the last line may lack its end
  return element.minimal_row_size(ascii) > 0 && element.count > (bytes_left + missing_newline) / row;
}

/// Reads the lines of one element; skips them when `table` is null.
void read_ascii_rows(TextLines& lines, const PlyElement& element, CloudTable* table) {
  std::vector<double> numbers;
  for (std::size_t row = 0; row < element.count; ++row) {
    const auto line = lines.next_with_content();
    if (!line)
      lines.fail("the file ends after " + std::to_string(row) + " of " + std::to_string(element.count) +
                 " lines of element '" + element.name + "'");
    if (table == nullptr) continue;
    lines.parse_numbers(*line, numbers);
    std::size_t at = 0;
    for (std::size_t c = 0; c < element.properties.size(); ++c) {
      if (at >= numbers.size())
        lines.fail("the line has only " + std::to_string(numbers.size()) + " numbers, '" +
                   element.properties[c].name + "' is missing");
      const double value = numbers[at++];
      if (table->uses(c)) table->set(c, value);
      if (!element.properties[c].count_type) continue;
      if (!(value >= 0 && value <= static_cast<double>(numbers.size() - at)))
        lines.fail("the list '" + element.properties[c].name + "' is longer than its line");
      at += static_cast<std::size_t>(value);
    }
    if (at != numbers.size())
      lines.fail("the line has " + std::to_string(numbers.size()) + " numbers where the header promises " +
                 std::to_string(at));
    table->end_point();
  }
}

/// A cursor over the binary rows.
struct BinaryRows {
  const std::string& path;
  ByteSource& source;
  bool big_endian;

  double take(ScalarType type, const PlyElement& element, std::size_t row) {
    const std::string_view next = source.peek(size_of(type));
    if (next.size() < size_of(type))
      fail_at_byte(path, source.offset(),
                   "the file ends within row " + std::to_string(row) + " of " +
                       std::to_string(element.count) + " of element '" + element.name + "'");
    const double value = read_scalar(reinterpret_cast<const std::uint8_t*>(next.data()), type, big_endian);
    source.skip(size_of(type));
    return value;
  }

  void skip_list(const PlyProperty& property, const PlyElement& element, std::size_t row) {
    const std::size_t start = source.offset();
    const double count = take(*property.count_type, element, row);
    if (count < 0 || count > static_cast<double>(source.left() / size_of(property.type)))
      fail_at_byte(path, start,
                   "row " + std::to_string(row) + " of element '" + element.name + "' has a list of " +
                       std::to_string(static_cast<std::int64_t>(count)) +
                       " entries, which runs past the end");
    source.skip(static_cast<std::size_t>(count) * size_of(property.type));
  }

  void read(const PlyElement& element, CloudTable* table) {
    if (table == nullptr && !element.has_lists()) {
      source.skip(element.count * element.minimal_row_size(false));  // checked by cannot_hold
      return;
    }
    for (std::size_t row = 0; row < element.count; ++row) {
      for (std::size_t c = 0; c < element.properties.size(); ++c) {
        const PlyProperty& property = element.properties[c];
        if (property.count_type) {
          skip_list(property, element, row);
          continue;
        }
        const double value = take(property.type, element, row);
        if (table != nullptr && table->uses(c)) table->set(c, value);
      }
      if (table != nullptr) table->end_point();
    }
  }
};

}  // namespace

void parse_ply(const std::string& path, ByteSource& source, const PointSink& sink) {
  TextLines lines(path, source);
  const PlyHeader header = read_ply_header(lines);
  const bool ascii = header.format == PlyHeader::Format::kAscii;
  BinaryRows binary{path, source, header.format == PlyHeader::Format::kBigEndian};
  for (const PlyElement& element : header.elements) {
    const std::size_t left = source.left();
    if (element.properties.empty()) continue;
    if (cannot_hold(element, ascii, left)) {
      if (ascii) lines.fail(too_short(element, left));
      fail_at_byte(path, source.offset(), too_short(element, left));
    }
    std::optional<CloudTable> table;
    if (element.name == "vertex") {
      const auto arrays = arrays_of(element);
      const std::string missing = missing_coordinate(arrays);
      if (!missing.empty()) lines.fail("the element vertex has no property '" + missing + "'");
      table.emplace(arrays, element.count, sink);
    }
    if (ascii)
      read_ascii_rows(lines, element, table ? &*table : nullptr);
    else
      binary.read(element, table ? &*table : nullptr);
    if (table) return table->hand_on();  // the elements after the points are not used
  }
  lines.fail("the file has no element 'vertex' with properties");
}

std::string format_ply(const PointCloud& cloud) {
  const auto columns = columns_of(cloud);
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(cloud.size()) + "\n";
  for (const NamedArray& column : columns) bytes += std::string("property float ") + column.name + "\n";
  bytes += "end_header\n";
  append_rows(bytes, columns);
  return bytes;
}

}  // namespace scanlock
