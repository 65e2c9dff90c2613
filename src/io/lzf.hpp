// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanlock {

/// Three bytes of LZF can stand for at most this many.
constexpr std::size_t kLzfLargestCopy = 264;

/// Undoes LZF, the compression of PCD's binary_compressed. Nothing when the data is damaged or does not give
/// exactly `size` bytes; a `size` that `compressed_size` bytes cannot give is refused before it is allocated.
std::optional<std::vector<std::uint8_t>> lzf_decompress(const std::uint8_t* compressed,
                                                        std::size_t compressed_size, std::size_t size);

}  // namespace scanlock
