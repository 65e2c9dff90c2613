// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanlock {

/// The whole file. Throws std::runtime_error as InputFile.
std::vector<std::uint8_t> read_file_bytes(const std::string& path);

/// Replaces the file as a whole (see replace_file()), or writes to the device, FIFO or descriptor that it is.
/// Throws std::runtime_error naming the path and the system's reason when not all of it can be written.
void write_file_bytes(const std::string& path, std::string_view bytes);

}  // namespace scanlock
