// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace scanlock {

/// A file to be read from its begin on, and its `size` in bytes. Throws as the next one.
std::ifstream open_file(const std::string& path, std::size_t* size);

/// The whole file. Throws std::runtime_error naming the path when it is missing, no regular file, or
/// unreadable.
std::vector<std::uint8_t> read_file_bytes(const std::string& path);

/// Replaces the file as a whole (see replace_file()), or writes to the device, FIFO or descriptor that it is.
/// Throws std::runtime_error naming the path and the system's reason when not all of it can be written.
void write_file_bytes(const std::string& path, std::string_view bytes);

}  // namespace scanlock
