// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/match_file.hpp"

#include <stdexcept>

#include "io/byte_source.hpp"
#include "io/text_lines.hpp"

namespace scanlock {

Matches read_matches(const std::string& path, std::size_t most) {
  ByteSource source(path);
  TextLines lines(path, source);
  Matches matches;
  std::vector<double> numbers;
  while (const auto line = lines.next_with_content()) {
    lines.parse_finite(*line, numbers);
    if (numbers.size() != 6)
      lines.fail("a match has 6 numbers (px py pz qx qy qz), this line has " +
                 std::to_string(numbers.size()));
    if (matches.size() == most)
      lines.fail("more than " + std::to_string(most) +
                 " matches; keep those with the most similar descriptors");
    matches.push_back({{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}});
  }
  if (matches.empty())
    throw std::runtime_error(path + ": holds no matches; a match is a line of 6 numbers: px py pz qx qy qz");
  return matches;
}

}  // namespace scanlock
