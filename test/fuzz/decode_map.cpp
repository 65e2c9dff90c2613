// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/crc32.hpp"
#include "io/map_file.hpp"

using namespace scanlock;

/// Decodes the input as it is, and with a correct size and checksum, which mutations would not find.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kHeader = 20, kChecksum = 4;
  std::vector<std::uint8_t> bytes(data, data + size);
  fuzz::allow_errors([&] { decode_map(bytes, "input"); });
  if (size < kHeader + kChecksum) return 0;
  const std::uint64_t body = size - kHeader - kChecksum;
  for (std::size_t i = 0; i < 8; ++i) bytes[12 + i] = static_cast<std::uint8_t>(body >> 8 * i);
  const std::uint32_t checksum = crc32(bytes.data(), size - kChecksum);
  for (std::size_t i = 0; i < kChecksum; ++i)
    bytes[size - kChecksum + i] = static_cast<std::uint8_t>(checksum >> 8 * i);
  fuzz::allow_errors([&] { encode_map(decode_map(bytes, "input")); });
  return 0;
}
