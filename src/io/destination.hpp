// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace scanlock {

/// Where a write to a name goes.
struct Destination {
  enum class Kind {
    kNothing,    ///< nothing there yet
    kFile,       ///< a regular file
    kDirectory,  ///< a directory
    kSpecial     ///< a device, FIFO or socket, or an open descriptor (/dev/stdout): nothing in it can be lost
  };
  std::string path;  ///< absolute; links are followed, also one to a file that is not there yet
  Kind kind = Kind::kNothing;
};

/// Throws std::runtime_error naming `name` where its links lead round in a circle or its folder is barred.
Destination destination_of(const std::string& name);

/// Whether two destinations are one file, whatever their spelling, links and hard links.
bool same_file(const Destination& a, const Destination& b);

}  // namespace scanlock
