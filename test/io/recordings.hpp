// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <filesystem>

namespace scanlock {

/// The folder of recorded scans, which are not part of the project; tests that use it report themselves as
/// skipped where it is missing.
inline std::filesystem::path recordings() {
  const char* given = std::getenv("SCANLOCK_DATA");
  return given != nullptr ? given : SCANLOCK_SOURCE_DIR "/../shared/data";
}

}  // namespace scanlock
