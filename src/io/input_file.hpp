// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace scanlock {

/// A regular file that is open for reading at any offset, by several threads at once. It keeps reading the
/// file that it opened, even after another file has been renamed to the same path.
class InputFile {
 public:
  /// Throws std::runtime_error naming the path when the file is missing, not a regular file, or unreadable.
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::size_t size() const { return size_; }  ///< bytes, at the time of opening
  /// Reads `count` bytes from `offset` on. Throws std::runtime_error naming the path when they cannot be
  /// read.
  void read(std::size_t offset, std::size_t count, void* to) const;

 private:
  std::string path_;
  std::size_t size_ = 0;
  int fd_ = -1;
};

}  // namespace scanlock
