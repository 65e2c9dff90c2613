// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace scanlock {

/// Replaces or creates the file so that at any instant, even after a kill or a power cut, the path holds
/// either the complete old content or the complete new content: a temporary file beside it is written, synced
/// and renamed over it. A symbolic link is followed. `write` passes the content on piece by piece. Throws
/// std::runtime_error naming the path, or whatever `write` throws; the old file is then unchanged and the
/// temporary file is removed.
using TakeBytes = std::function<void(std::string_view bytes)>;
void write_file_atomically(const std::string& path, const std::function<void(const TakeBytes&)>& write);

/// As write_file_atomically(), but not safe against a power cut: it does not wait for the disk.
void replace_file(const std::string& path, std::string_view bytes);

}  // namespace scanlock
