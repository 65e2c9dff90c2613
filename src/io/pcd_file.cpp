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

void read_ascii(TextLines& lines, const PcdHeader& header, const std::vector<CloudArray>& arrays,
                const PointSink& sink) {
  // A point takes at least one character and one separator or line end per word.
  if (header.points > (lines.bytes_left() + 1) / (2 * header.point_words))
    lines.fail("the header promises " + std::to_string(header.points) + " points, more than the " +
               std::to_string(lines.bytes_left()) + " bytes that follow can hold: the file is cut short");
  CloudTable table(arrays, header.points, sink);
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
      if (table.uses(f)) table.set(f, numbers[header.fields[f].word]);
    table.end_point();
  }
  table.hand_on();
}

/// The points are stored one after another.
void read_binary(ByteSource& source, const PcdHeader& header, const std::vector<CloudArray>& arrays,
                 const PointSink& sink) {
  CloudTable table(arrays, header.points, sink);
  for (std::size_t i = 0; i < header.points; ++i) {
    const auto* const point = reinterpret_cast<const std::uint8_t*>(source.peek(header.point_size).data());
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      const PcdField& field = header.fields[f];
      if (table.uses(f)) table.set(f, read_scalar(point + field.offset, *scalar_type(field), false));
    }
    source.skip(header.point_size);
    table.end_point();
  }
  table.hand_on();
}

/// The fields are stored one after another, which is the layout of compressed data.
void read_fields(const std::vector<std::uint8_t>& bytes, const PcdHeader& header,
                 const std::vector<CloudArray>& arrays, const PointSink& sink) {
  CloudTable table(arrays, header.points, sink);
  for (std::size_t i = 0; i < header.points; ++i) {
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      const PcdField& field = header.fields[f];
      if (!table.uses(f)) continue;
      const std::size_t at = field.offset * header.points + i * field.size * field.count;
      table.set(f, read_scalar(&bytes[at], *scalar_type(field), false));
    }
    table.end_point();
  }
  table.hand_on();
}

/// The uncompressed bytes of a binary_compressed body.
std::vector<std::uint8_t> decompress(const std::string& path, ByteSource& source, const PcdHeader& header) {
  const std::size_t offset = source.offset();
  if (source.left() < 8) fail_at_byte(path, offset, "the file ends before the sizes of its compressed data");
  const std::vector<std::uint8_t> sizes = source.take(8);
  const auto compressed = static_cast<std::size_t>(read_scalar(sizes.data(), ScalarType::kUint32, false));
  const auto size = static_cast<std::size_t>(read_scalar(&sizes[4], ScalarType::kUint32, false));
  if (compressed > source.left())
    fail_at_byte(path, offset,
                 std::to_string(compressed) + " bytes of compressed data are promised, " +
                     std::to_string(source.left()) + " follow: the file is cut short");
  if (size / header.point_size < header.points)
    fail_at_byte(path, offset + 4,
                 std::to_string(size) + " bytes of data cannot hold the " + std::to_string(header.points) +
                     " points of the header");
  auto data = lzf_decompress(source.take(compressed).data(), compressed, size);
  if (!data) fail_at_byte(path, offset + 8, "the compressed data is damaged");
  return std::move(*data);
}

}  // namespace

void parse_pcd(const std::string& path, ByteSource& source, const PointSink& sink) {
  TextLines lines(path, source);
  const PcdHeader header = read_pcd_header(lines);
  const auto arrays = arrays_of(header);
  const std::string missing = missing_coordinate(arrays);
  if (!missing.empty()) lines.fail("the file has no field '" + missing + "' of a known TYPE and SIZE");
  if (header.data == PcdHeader::Data::kAscii) return read_ascii(lines, header, arrays, sink);
  if (header.points == 0) return;
  if (header.data == PcdHeader::Data::kCompressed)
    return read_fields(decompress(path, source, header), header, arrays, sink);
  if (source.left() / header.point_size < header.points)
    fail_at_byte(path, source.offset(),
                 "the header promises " + std::to_string(header.points) + " points of " +
                     std::to_string(header.point_size) + " bytes, only " + std::to_string(source.left()) +
                     " bytes follow: the file is cut short");
  read_binary(source, header, arrays, sink);
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
