// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include "messages/decode_scan.hpp"
#include "messages/generated_bytes.hpp"

namespace scanlock {

/// Our decoding of a message that lcm-gen's code has encoded.
template <typename Message>
DecodedScan decode(const Message& message, const DecodeLimits& limits = {}) {
  const Bytes bytes = generated_bytes(message);
  return decode_scan(bytes.data(), bytes.size(), limits);
}

/// The decoding by lcm-gen's code of a message that we have encoded.
template <typename Message>
Message theirs(const Bytes& bytes) {
  Message message{};
  REQUIRE(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size()));
  return message;
}

}  // namespace scanlock
