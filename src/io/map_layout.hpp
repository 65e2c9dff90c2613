// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace scanlock {

// The first bytes of a map file, and the sizes of its parts in bytes: see map_file.hpp.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'S', 'L', 'M', 'A', 'P', '\r', '\n'};
inline constexpr std::size_t kPoseBytes = 12 * 8, kUpBytes = 3 * 8, kChecksumBytes = 4;
inline constexpr std::size_t kKeyframeBytes = 8 + kPoseBytes + 4 + 4 + 4;  // without its points
inline constexpr std::size_t kConstraintBytes = 4 + 4 + kPoseBytes + 4 + 21 * 8;
inline constexpr std::size_t kPointBytes = 3 * 2, kStandBytes = 3 * 4;
inline constexpr int kFinestStep = -24, kCoarsestStep = 24;  // k of the step 2^k metres
inline constexpr double kMostSteps = 32767;

/// The bits of a value, reinterpreted as another type of the same size.
template <typename Unsigned, typename Value>
Unsigned bits_of(Value value) {
  static_assert(sizeof(Unsigned) == sizeof(Value));
  Unsigned bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

inline std::string_view as_text(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline const std::uint8_t* as_bytes(std::string_view text) {
  return reinterpret_cast<const std::uint8_t*>(text.data());
}

}  // namespace scanlock
