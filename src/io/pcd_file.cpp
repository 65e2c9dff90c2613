// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/cloud_columns.hpp"
#include "io/cloud_formats.hpp"
#include "io/lzf.hpp"
#include "io/pcd_header.hpp"
#include "io/text_lines.hpp"

namespace scanlock {
namespace {

std::vector<CloudArray> arrays_of(const PcdHeader& header) {
  std::vector<CloudArray> arrays;
  for (const PcdField& field : header.fields) {
    const auto type = scalar_type(field);
    arrays.push_back(type && field.count > 0 ? array_for(field.name, *type) : nullptr);
  }
  return arrays;
}

PointCloud read_ascii(TextLines& lines, const PcdHeader& header, const std::vector<CloudArray>& arrays) {
  // A point takes at least a character for each word and one behind it.
  if (header.points > (lines.bytes_left() + 1) / (2 * header.point_words))
    lines.fail("the header promises " + std::to_string(header.points) + " points, more than the " +
               std::to_string(lines.bytes_left()) + " bytes that follow can hold: the file is cut short");
  CloudTable table(arrays, header.points);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < header.points; ++i) {
    const auto line = lines.next_with_content();
    if (!line)
      lines.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(header.points) +
                 " points");
    lines.parse_numbers(*line, numbers);
    if (numbers.size() != header.point_words)
      lines.fail("a point of " + std::to_string(numbers.size()) + " numbers where the header promises " +
                 std::to_string(header.point_words));
    for (std::size_t f = 0; f < header.fields.size(); ++f)
      if (table.uses(f)) table.set(f, i, numbers[header.fields[f].word]);
  }
  return table.take();
}

/// Where the values of the fields lie: those of field f of point i at start[f] + i * step[f].
struct Layout {
  std::vector<std::size_t> start, step;
};

Layout point_by_point(const PcdHeader& header) {
  Layout layout;
  for (const PcdField& field : header.fields) {
    layout.start.push_back(field.offset);
    layout.step.push_back(header.point_size);
  }
  return layout;
}

Layout field_by_field(const PcdHeader& header) {
  Layout layout;
  for (const PcdField& field : header.fields) {
    layout.start.push_back(field.offset * header.points);
    layout.step.push_back(field.size * field.count);
  }
  return layout;
}

PointCloud read_values(const std::uint8_t* bytes, const PcdHeader& header, const Layout& layout,
                       const std::vector<CloudArray>& arrays) {
  CloudTable table(arrays, header.points);
  for (std::size_t f = 0; f < header.fields.size(); ++f) {
    if (!table.uses(f)) continue;
    const ScalarType type = *scalar_type(header.fields[f]);
    for (std::size_t i = 0; i < header.points; ++i)
      table.set(f, i, read_scalar(bytes + layout.start[f] + i * layout.step[f], type, false));
  }
  return table.take();
}

/// The uncompressed bytes of a binary_compressed body that begins at `offset`.
std::vector<std::uint8_t> decompress(const std::string& path, const std::vector<std::uint8_t>& bytes,
                                     std::size_t offset, const PcdHeader& header) {
  if (bytes.size() - offset < 8)
    fail_at_byte(path, offset, "the file ends before the sizes of its compressed data");
  const auto compressed = static_cast<std::size_t>(read_scalar(&bytes[offset], ScalarType::kUint32, false));
  const auto size = static_cast<std::size_t>(read_scalar(&bytes[offset + 4], ScalarType::kUint32, false));
  if (compressed > bytes.size() - offset - 8)
    fail_at_byte(path, offset,
                 std::to_string(compressed) + " bytes of compressed data are promised, " +
                     std::to_string(bytes.size() - offset - 8) + " follow: the file is cut short");
  if (size / header.point_size < header.points)
    fail_at_byte(path, offset + 4,
                 std::to_string(size) + " bytes of data cannot hold the " + std::to_string(header.points) +
                     " points of the header");
  auto data = lzf_decompress(bytes.data() + offset + 8, compressed, size);
  if (!data) fail_at_byte(path, offset + 8, "the compressed data is damaged");
  return std::move(*data);
}

}  // namespace

PointCloud parse_pcd(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  TextLines lines(path, bytes);
  const PcdHeader header = read_pcd_header(lines);
  const auto arrays = arrays_of(header);
  const std::string missing = missing_coordinate(arrays);
  if (!missing.empty()) lines.fail("the file has no field '" + missing + "' of a known TYPE and SIZE");
  if (header.data == PcdHeader::Data::kAscii) return read_ascii(lines, header, arrays);
  const std::size_t offset = lines.offset();
  if (header.points == 0) return {};
  if (header.data == PcdHeader::Data::kCompressed) {
    const auto data = decompress(path, bytes, offset, header);
    return read_values(data.data(), header, field_by_field(header), arrays);
  }
  if ((bytes.size() - offset) / header.point_size < header.points)
    fail_at_byte(path, offset,
                 "the header promises " + std::to_string(header.points) + " points of " +
                     std::to_string(header.point_size) + " bytes, only " +
                     std::to_string(bytes.size() - offset) + " bytes follow: the file is cut short");
  return read_values(bytes.data() + offset, header, point_by_point(header), arrays);
}

std::string format_pcd(const PointCloud& cloud) {
  const auto columns = columns_of(cloud, "normal_x", "normal_y", "normal_z");
  std::string fields, sizes, types, counts;
  for (const NamedArray& column : columns) {
    fields += std::string(" ") + column.name;
    sizes += " 4";
    types += " F";
    counts += " 1";
  }
  const std::string points = std::to_string(cloud.size());
  std::string bytes = "# .PCD v0.7\nVERSION 0.7\nFIELDS" + fields + "\nSIZE" + sizes + "\nTYPE" + types +
                      "\nCOUNT" + counts + "\nWIDTH " + points +
                      "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA binary\n";
  append_rows(bytes, columns);
  return bytes;
}

}  // namespace scanlock
