// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <array>
#include <cstdio>
#include <utility>

#include "io/cloud_columns.hpp"
#include "io/cloud_formats.hpp"
#include "io/text_lines.hpp"

namespace scanlock {

void parse_xyz(const std::string& path, ByteSource& source, const PointSink& sink) {
  TextLines lines(path, source);
  PointCloud cloud;
  std::vector<double> numbers;
  std::size_t columns = 0;
  while (const auto line = lines.next_with_content()) {
    lines.parse_numbers(*line, numbers);
    if (columns == 0) columns = numbers.size();
    if (columns != 3 && columns != 4)
      lines.fail("a point has 3 or 4 numbers (x y z [intensity]), this line has " + std::to_string(columns));
    if (numbers.size() != columns)
      lines.fail(std::to_string(numbers.size()) + " numbers where the lines before have " +
                 std::to_string(columns));
    cloud.push_back(to_float(numbers[0] - sink.offset.x()), to_float(numbers[1] - sink.offset.y()),
                    to_float(numbers[2] - sink.offset.z()));
    if (columns == 4) cloud.intensity.push_back(to_float(numbers[3]));
    if (cloud.size() == kPartPoints) sink.take(std::exchange(cloud, PointCloud()));
  }
  if (!cloud.empty()) sink.take(std::move(cloud));
}

std::string format_xyz(const PointCloud& cloud) {
  std::string text;
  std::array<char, 128> line{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    int size = std::snprintf(line.data(), line.size(), "%.9g %.9g %.9g", cloud.x[i], cloud.y[i], cloud.z[i]);
    text.append(line.data(), static_cast<std::size_t>(size));
    if (cloud.has_intensity()) {
      size = std::snprintf(line.data(), line.size(), " %.9g", cloud.intensity[i]);
      text.append(line.data(), static_cast<std::size_t>(size));
    }
    text += '\n';
  }
  return text;
}

}  // namespace scanlock
