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

/// Bytes that are read forward: of memory, or of a file, of which one piece at a time is held.
class ByteSource {
 public:
  /// `bytes` must outlive this object.
  explicit ByteSource(const std::vector<std::uint8_t>& bytes);
  /// Opens a file. Throws std::runtime_error as InputFile, here and where the file turns out shorter than it
  /// was when it was opened.
  explicit ByteSource(const std::string& path);
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  std::size_t offset() const { return offset_; }        ///< bytes that were skipped
  std::size_t left() const { return size_ - offset_; }  ///< bytes after those
  /// Null for bytes of memory.
  const std::shared_ptr<const InputFile>& file() const { return file_; }
  /// The bytes that come next: at least `count` of them or, where fewer are left, all. Valid until the next
  /// peek.
  std::string_view peek(std::size_t count) {
    if (window_.size() < count && window_.size() < left()) fill(count);
    return window_;
  }
  /// `count`: at most left().
  void skip(std::size_t count);
  /// Takes `count` bytes, at most left().
  std::vector<std::uint8_t> take(std::size_t count);

 private:
  void fill(std::size_t count);

  std::size_t offset_ = 0, size_ = 0;
  std::shared_ptr<const InputFile> file_;
  std::vector<char> piece_;  ///< of the file
  std::string_view window_;  ///< from offset_ on
};

}  // namespace scanlock
