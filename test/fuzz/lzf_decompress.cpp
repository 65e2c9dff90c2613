// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/lzf.hpp"

/// The first two bytes are the requested size.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t wanted = data[0] | static_cast<std::size_t>(data[1]) << 8;
  const auto bytes = scanlock::lzf_decompress(data + 2, size - 2, wanted);
  scanlock::fuzz::require(!bytes || bytes->size() == wanted);
  return 0;
}
