// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace scanlock {

InputFile::InputFile(const std::string& path) : path_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw std::runtime_error(path + ": no such file");
  if (error) throw std::runtime_error(path + ": cannot open: " + error.message());
  if (std::filesystem::is_directory(status)) throw std::runtime_error(path + ": is a directory, not a file");
  if (!std::filesystem::is_regular_file(status)) throw std::runtime_error(path + ": not a regular file");
  fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat info = {};
  if (fd_ < 0 || fstat(fd_, &info) != 0) {
    const std::string reason = std::strerror(errno);
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error(path + ": cannot open: " + reason);
  }
  size_ = static_cast<std::size_t>(info.st_size);
}

InputFile::~InputFile() {
  close(fd_);
}

void InputFile::read(std::size_t offset, std::size_t count, void* to) const {
  for (std::size_t done = 0; done < count;) {
    const ssize_t got =
        pread(fd_, static_cast<char*>(to) + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      throw std::runtime_error(path_ + ": cannot read all of its " + std::to_string(size_) + " bytes" +
                               (got < 0 ? std::string(": ") + std::strerror(errno) : ""));
    }
    done += static_cast<std::size_t>(got);
  }
}

}  // namespace scanlock
