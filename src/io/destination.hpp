// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace scanlock {

/// The file that is written when a program opens this name for writing.
struct Destination {
  enum class Kind {
    kNothing,    ///< does not exist yet
    kFile,       ///< a regular file
    kDirectory,  ///< a directory
    kSpecial     ///< device, FIFO, socket or open descriptor (/dev/stdout): a write destroys no data
  };
  std::string path;  ///< absolute, with links resolved, even a link to a file that does not exist yet
  Kind kind = Kind::kNothing;
};

/// Throws std::runtime_error naming `name` when its links form a loop or its folder is not accessible.
Destination destination_of(const std::string& name);

/// Whether two destinations are the same file, regardless of spelling, symbolic links and hard links.
bool same_file(const Destination& a, const Destination& b);

}  // namespace scanlock
