// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/crc32.hpp"

#include <array>

namespace scanlock {
namespace {

constexpr std::size_t kStride = 16;  // bytes processed in one step
using Table = std::array<std::uint32_t, 256>;

/// Slicing (Kounavis and Berry 2008): table k holds the remainder of each byte value followed by k zero
/// bytes.
constexpr std::array<Table, kStride> make_tables() {
  std::array<Table, kStride> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit)
      remainder = (remainder >> 1) ^ ((remainder & 1u) != 0 ? 0xEDB88320u : 0u);
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < kStride; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xFFu];
    }
  }
  return tables;
}
constexpr std::array<Table, kStride> kTables = make_tables();

}  // namespace

std::uint32_t crc32(const std::uint8_t* data, std::size_t size, std::uint32_t before) {
  std::uint32_t remainder = ~before;
  std::size_t i = 0;
  for (; i + kStride <= size; i += kStride) {
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < kStride; ++k) {
      const std::uint32_t carried = k < sizeof remainder ? (remainder >> (8 * k)) & 0xFFu : 0u;
      next ^= kTables[kStride - 1 - k][data[i + k] ^ carried];
    }
    remainder = next;
  }
  for (; i < size; ++i) remainder = (remainder >> 8) ^ kTables[0][(remainder ^ data[i]) & 0xFFu];
  return ~remainder;
}

}  // namespace scanlock
