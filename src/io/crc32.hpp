// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace scanlock {

/// CRC-32 as used by zip and PNG (reflected, polynomial 0x04C11DB7): "123456789" gives 0xCBF43926. `before`:
/// the CRC of the bytes that precede these.
std::uint32_t crc32(const std::uint8_t* data, std::size_t size, std::uint32_t before = 0);

}  // namespace scanlock
