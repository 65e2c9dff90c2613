// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace scanlock {

/// A regular file that is open for reading, at any place and by several threads at once. It stays the same
/// file when another one takes its name.
class InputFile {
 public:
  /// Throws std::runtime_error naming the path when it is missing, no regular file, or unreadable.
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  std::size_t size() const { return size_; }  ///< bytes, when it was opened
  /// `count` bytes from `offset` on. Throws std::runtime_error naming the path when they cannot be read.
  void read(std::size_t offset, std::size_t count, void* to) const;

 private:
  std::string path_;
  std::size_t size_ = 0;
  int fd_ = -1;
};

}  // namespace scanlock
