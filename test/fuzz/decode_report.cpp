// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/decode_report.hpp"

#include "fuzz.hpp"

using namespace scanlock;

namespace {

template <typename Value>
void check(const Decoded<Value>& decoded) {
  fuzz::require(decoded.ok() == decoded.error.empty());
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(decode_pose(data, size));
  check(decode_odometry(data, size));
  check(decode_status(data, size));
  check(decode_recovery(data, size));
  check(decode_command(data, size));
  check(decode_attitude(data, size));
  return 0;
}
