// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/cloud_formats.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> bytes(data, data + size);
  scanlock::ByteSource source(bytes);
  scanlock::fuzz::allow_errors([&] { scanlock::parse_ply("input", source, [](scanlock::PointCloud&&) {}); });
  return 0;
}
