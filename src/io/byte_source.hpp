// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/input_file.hpp"

namespace scanlock {

/// Bytes that are read from front to back, either from memory or from a file; of a file, only one piece at a
/// time is held in memory.
class ByteSource {
 public:
  /// `bytes` must outlive this object.
  explicit ByteSource(const std::vector<std::uint8_t>& bytes);
  /// Opens a file. Throws std::runtime_error as InputFile does, here and in later reads when the file has
  /// become shorter than it was when it was opened.
  explicit ByteSource(const std::string& path);
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  std::size_t offset() const { return offset_; }        ///< bytes consumed so far
  std::size_t left() const { return size_ - offset_; }  ///< bytes not yet consumed
  /// The file that is read; null when the bytes come from memory.
  const std::shared_ptr<const InputFile>& file() const { return file_; }
  /// The next bytes, without consuming them: at least `count`, or all that are left when there are fewer. The
  /// view is valid until the next call of peek().
  std::string_view peek(std::size_t count) {
    if (window_.size() < count && window_.size() < left()) fill(count);
    return window_;
  }
  /// Consumes `count` bytes; `count` must not exceed left().
  void skip(std::size_t count);
  /// Consumes and returns `count` bytes; `count` must not exceed left().
  std::vector<std::uint8_t> take(std::size_t count);

 private:
  void fill(std::size_t count);

  std::size_t offset_ = 0, size_ = 0;
  std::shared_ptr<const InputFile> file_;
  std::vector<char> piece_;  ///< the piece of the file that is held
  std::string_view window_;  ///< the bytes in memory from offset_ on
};

}  // namespace scanlock
