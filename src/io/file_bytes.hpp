// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanlock {

/// Reads the whole file. Throws std::runtime_error as InputFile does.
std::vector<std::uint8_t> read_file_bytes(const std::string& path);

/// Replaces a regular file as a whole (see replace_file()); writes to a device, FIFO or descriptor directly.
/// Throws std::runtime_error naming the path and the system's reason when some of the bytes cannot be
/// written.
void write_file_bytes(const std::string& path, std::string_view bytes);

}  // namespace scanlock
