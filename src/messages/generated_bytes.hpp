// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace scanlock {

/// Encodes a message with lcm-gen's encoder, which is safe only for messages whose counts match their arrays:
/// use it for messages filled by scanlock.
template <typename Message>
std::vector<unsigned char> generated_bytes(const Message& message) {
  std::vector<unsigned char> bytes(static_cast<std::size_t>(std::max(0, message.getEncodedSize())));
  const int written = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max(0, written)));
  return bytes;
}

/// A string that LCM can encode: without zero bytes, and at most 4096 bytes long.
inline std::string wire_string(const std::string& text) {
  constexpr std::size_t kMaxLength = 4096;
  std::string result = text.substr(0, kMaxLength);
  result.erase(std::remove(result.begin(), result.end(), '\0'), result.end());
  return result;
}

}  // namespace scanlock
