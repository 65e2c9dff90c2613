// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/file_bytes.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace scanlock {

std::vector<std::uint8_t> read_file_bytes(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw std::runtime_error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw std::runtime_error(path + ": not a regular file");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot open: " + std::strerror(errno));
  std::vector<std::uint8_t> bytes(std::filesystem::file_size(path));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file)
    throw std::runtime_error(path + ": cannot read all of its " + std::to_string(bytes.size()) + " bytes");
  return bytes;
}

void write_file_bytes(const std::string& path, std::string_view bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) throw std::runtime_error(path + ": cannot create: " + std::strerror(errno));
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot write (is the disk full?)");
}

}  // namespace scanlock
