// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/config.hpp"
#include "fuzz.hpp"

using namespace scanlock;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::allow_errors([&] {
    const Config config = parse_config({reinterpret_cast<const char*>(data), size}, "input");
    parse_config(print_config(config), "printed");
  });
  return 0;
}
