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

/// Walks over the lines of a text, and knows where it is for the sake of errors.
class TextLines {
 public:
  /// `path` is for the errors only. `source` must outlive this object, and stands behind the last line.
  TextLines(std::string path, ByteSource& source) : path_(std::move(path)), source_(source) {}

  /// The next line without its end (LF or CR LF), or nothing at the end of the text; valid until the next
  /// one. Fails for a line of more than 1 MB.
  std::optional<std::string_view> next();
  /// The next line that holds more than blanks once its `#` comment is cut off.
  std::optional<std::string_view> next_with_content();

  std::size_t line() const { return line_; }  ///< number of the line last returned, from 1
  std::size_t bytes_left() const { return source_.left(); }

  /// Throws std::runtime_error "PATH:LINE: what", before the first line "PATH: what".
  [[noreturn]] void fail(const std::string& what) const;
  /// The words of a line as numbers ("nan" and "inf" are numbers); fails naming the word that is none.
  void parse_numbers(std::string_view text, std::vector<double>& numbers) const;
  /// The same, and fails naming a number that is not finite.
  void parse_finite(std::string_view text, std::vector<double>& numbers) const;

 private:
  std::string path_;
  ByteSource& source_;
  std::size_t line_ = 0;
};

/// A word for an error message: in quotes, not too long, nothing unprintable.
std::string quoted(std::string_view word);

/// Splits at blanks, tabs and commas.
std::vector<std::string_view> split_words(std::string_view text);

/// A whole number without a sign, or nothing when the word is anything else or does not fit.
std::optional<std::uint64_t> parse_unsigned(std::string_view word);

}  // namespace scanlock
