// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "fuzz.hpp"
#include "io/log_poses.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string error;
  const auto pose = scanlock::decode_pose(data, size, error);
  scanlock::fuzz::require(!pose || pose->pose.matrix().allFinite());
  return 0;
}
