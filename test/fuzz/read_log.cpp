// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/lcm_log.hpp"

using namespace scanlock;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  LogReader reader(file.path());
  std::size_t bytes = 0;
  while (const auto event = reader.next()) bytes += event->channel.size() + event->data.size();
  fuzz::require(bytes <= size);
  return 0;
}
