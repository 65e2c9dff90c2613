// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/cloud_formats.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  scanlock::fuzz::allow_errors([&] { scanlock::parse_xyz("input", {data, data + size}); });
  return 0;
}
