// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_source.hpp"

namespace scanlock {

/// Iterates over the lines of a text and counts them for error messages.
class TextLines {
 public:
  /// `path` is used in error messages only. `source` must outlive this object; its offset is behind the last
  /// line returned.
  TextLines(std::string path, ByteSource& source) : path_(std::move(path)), source_(source) {}

  /// The next line without its end (LF or CR LF), or nothing at the end of the text; valid until the next
  /// call. Fails for a line of more than 1 MB.
  std::optional<std::string_view> next();
  /// The next line that is not blank after its `#` comment is removed.
  std::optional<std::string_view> next_with_content();

  std::size_t line() const { return line_; }  ///< number of the last line returned, from 1
  std::size_t bytes_left() const { return source_.left(); }

  /// Throws std::runtime_error "PATH:LINE: what", or "PATH: what" before the first line.
  [[noreturn]] void fail(const std::string& what) const;
  /// Parses the words of a line as numbers ("nan" and "inf" are numbers); fails naming a word that is not a
  /// number.
  void parse_numbers(std::string_view text, std::vector<double>& numbers) const;
  /// As parse_numbers(), but also fails naming a number that is not finite.
  void parse_finite(std::string_view text, std::vector<double>& numbers) const;

 private:
  std::string path_;
  ByteSource& source_;
  std::size_t line_ = 0;
};

/// A word for an error message: quoted, cut after 40 characters, unprintable characters replaced.
std::string quoted(std::string_view word);

/// Splits at blanks, tabs and commas.
std::vector<std::string_view> split_words(std::string_view text);

/// A whole number without sign; nothing when the word is anything else or exceeds 64 bits.
std::optional<std::uint64_t> parse_unsigned(std::string_view word);

}  // namespace scanlock
