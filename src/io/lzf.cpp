// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/lzf.hpp"

#include <algorithm>

namespace scanlock {

// The format: a control byte c < 32 announces c + 1 literal bytes. Otherwise its upper three bits are a
// length (7: add the next byte), and its lower five bits, followed by one more byte, are a distance; length +
// 2 bytes are copied from distance + 1 bytes back. Source and target of the copy may overlap.
std::optional<std::vector<std::uint8_t>> lzf_decompress(const std::uint8_t* compressed,
                                                        std::size_t compressed_size, std::size_t size) {
  if (size / kLzfLargestCopy > compressed_size / 3 + 1) return std::nullopt;
  std::vector<std::uint8_t> output;
  output.reserve(size);
  std::size_t at = 0;
  while (at < compressed_size) {
    const std::size_t control = compressed[at++];
    if (control < 32) {
      const std::size_t count = control + 1;
      if (count > compressed_size - at || count > size - output.size()) return std::nullopt;
      output.insert(output.end(), compressed + at, compressed + at + count);
      at += count;
      continue;
    }
    std::size_t length = control >> 5;
    if (compressed_size - at < (length == 7 ? 2u : 1u)) return std::nullopt;
    if (length == 7) length += compressed[at++];
    length += 2;
    const std::size_t distance = ((control & 31) << 8 | compressed[at++]) + 1;
    if (distance > output.size() || length > size - output.size()) return std::nullopt;
    for (std::size_t from = output.size() - distance; length > 0; --length, ++from) {
      const std::uint8_t byte = output[from];
      output.push_back(byte);
    }
  }
  if (output.size() != size) return std::nullopt;
  return output;
}

}  // namespace scanlock
