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
#include <fstream>
#include <stdexcept>

#include "io/atomic_file.hpp"
#include "io/destination.hpp"

namespace scanlock {
namespace {

/// A descriptor of our own, /dev/stdout, goes on where it is: opened anew, a file behind it would begin
/// again.
int open_special(const std::filesystem::path& path) {
  if (path.parent_path() == "/proc/" + std::to_string(getpid()) + "/fd")
    return dup(std::atoi(path.filename().c_str()));
  return open(path.c_str(), O_WRONLY | O_CLOEXEC);
}

}  // namespace

std::ifstream open_file(const std::string& path, std::size_t* size) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw std::runtime_error(path + ": no such file");
  if (error) throw std::runtime_error(path + ": cannot open: " + error.message());
  if (std::filesystem::is_directory(status)) throw std::runtime_error(path + ": is a directory, not a file");
  if (!std::filesystem::is_regular_file(status)) throw std::runtime_error(path + ": not a regular file");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot open: " + std::strerror(errno));
  *size = std::filesystem::file_size(path);
  return file;
}

std::vector<std::uint8_t> read_file_bytes(const std::string& path) {
  std::size_t size = 0;
  std::ifstream file = open_file(path, &size);
  std::vector<std::uint8_t> bytes(size);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file)
    throw std::runtime_error(path + ": cannot read all of its " + std::to_string(bytes.size()) + " bytes");
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
