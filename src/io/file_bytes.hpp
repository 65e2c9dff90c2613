// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanlock {

/// The whole file. Throws std::runtime_error naming the path when it is missing, no regular file, or
/// unreadable.
std::vector<std::uint8_t> read_file_bytes(const std::string& path);

/// Replaces the file. Throws std::runtime_error naming the path when the disk refuses any of it.
void write_file_bytes(const std::string& path, std::string_view bytes);

}  // namespace scanlock
