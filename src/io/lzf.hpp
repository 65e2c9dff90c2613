// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanlock {

/// The most bytes that three bytes of LZF can produce.
constexpr std::size_t kLzfLargestCopy = 264;

/// Decompresses LZF, which PCD's binary_compressed uses. Returns nothing when the data is damaged or does not
/// produce exactly `size` bytes. A `size` that `compressed_size` bytes cannot produce is rejected before it
/// is allocated.
std::optional<std::vector<std::uint8_t>> lzf_decompress(const std::uint8_t* compressed,
                                                        std::size_t compressed_size, std::size_t size);

}  // namespace scanlock
