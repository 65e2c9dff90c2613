// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace scanlock {

/// The bytes of a message that we filled ourselves: lcm-gen's encoder is sound when the counts match the
/// arrays.
template <typename Message>
std::vector<unsigned char> generated_bytes(const Message& message) {
  std::vector<unsigned char> bytes(static_cast<std::size_t>(std::max(0, message.getEncodedSize())));
  const int written = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max(0, written)));
  return bytes;
}

/// A string as LCM can carry it: without zeros, and short enough for a message under 64 KB.
inline std::string wire_string(const std::string& text) {
  constexpr std::size_t kMaxLength = 4096;
  std::string result = text.substr(0, kMaxLength);
  result.erase(std::remove(result.begin(), result.end(), '\0'), result.end());
  return result;
}

}  // namespace scanlock
