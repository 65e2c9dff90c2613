// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace scanlock {

/// Replaces the file, or creates it, so that at any instant (a kill, a power cut) either the old content or
/// the new one is there, whole: a temporary file beside it, synced, is renamed over it. A symbolic link is
/// followed. `write` hands the content over piece by piece. Throws std::runtime_error naming the path, or
/// what `write` throws; the old file is then untouched and nothing is left behind.
using TakeBytes = std::function<void(std::string_view bytes)>;
void write_file_atomically(const std::string& path, const std::function<void(const TakeBytes&)>& write);

/// The same but for the power cut: it does not wait for the disk.
void replace_file(const std::string& path, std::string_view bytes);

}  // namespace scanlock
