// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/trajectory.hpp"

using namespace scanlock;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  fuzz::allow_errors([&] { read_tum(file.path()); });
  fuzz::allow_errors([&] { read_kitti(file.path()); });
  return 0;
}
