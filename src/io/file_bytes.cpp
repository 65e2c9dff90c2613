// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/file_bytes.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "io/atomic_file.hpp"
#include "io/destination.hpp"
#include "io/input_file.hpp"

namespace scanlock {
namespace {

/// A descriptor of this process (/dev/stdout) is duplicated, which keeps its position: opening the name anew
/// would start at the beginning of the file behind it.
int open_special(const std::filesystem::path& path) {
  if (path.parent_path() == "/proc/" + std::to_string(getpid()) + "/fd")
    return dup(std::atoi(path.filename().c_str()));
  return open(path.c_str(), O_WRONLY | O_CLOEXEC);
}

}  // namespace

std::vector<std::uint8_t> read_file_bytes(const std::string& path) {
  const InputFile file(path);
  std::vector<std::uint8_t> bytes(file.size());
  file.read(0, bytes.size(), bytes.data());
  return bytes;
}

void write_file_bytes(const std::string& path, std::string_view bytes) {
  const Destination destination = destination_of(path);
  if (destination.kind != Destination::Kind::kSpecial) return replace_file(path, bytes);
  errno = 0;
  const int descriptor = open_special(destination.path);
  std::FILE* const file = descriptor < 0 ? nullptr : fdopen(descriptor, "wb");
  const bool written = file != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  if ((file != nullptr && std::fclose(file) != 0) || !written)
    throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
}

}  // namespace scanlock
