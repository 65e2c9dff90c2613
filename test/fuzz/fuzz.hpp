// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

/// libFuzzer calls this with one input after another; each file of this folder defines it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace scanlock::fuzz {

/// Ends the program, and so reports the input, where a required condition does not hold.
inline void require(bool holds) {
  if (!holds) std::abort();
}

/// A regular file in memory, for readers that take a path.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("input", 0)) {
    require(descriptor_ >= 0);
    require(write(descriptor_, data, size) == static_cast<ssize_t>(size));
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// The documented failure of a reader of files is std::runtime_error; anything else reaches libFuzzer.
template <typename Read>
void allow_errors(Read read) {
  try {
    read();
  } catch (const std::runtime_error&) {
    return;
  }
}

}  // namespace scanlock::fuzz
