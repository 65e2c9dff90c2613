// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace scanlock {
namespace {

/// Faster than std::string_view::find_first_of(), which calls a function per character.
bool is_separator(char c) {
  return c == ' ' || c == '\t' || c == ',' || c == '\r' || c == '\v' || c == '\f';
}

void skip_separators(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && is_separator(text[n])) ++n;
  text.remove_prefix(n);
}

/// Removes the first word from `text` and returns it; empty when no word is left.
std::string_view take_word(std::string_view& text) {
  skip_separators(text);
  std::size_t n = 0;
  while (n < text.size() && !is_separator(text[n])) ++n;
  const std::string_view word = text.substr(0, n);
  text.remove_prefix(n);
  return word;
}

}  // namespace

std::optional<std::string_view> TextLines::next() {
  if (source_.left() == 0) return std::nullopt;
  constexpr std::size_t kLine = 1u << 12, kLongest = 1u << 20;  // bytes
  std::string_view line;
  for (std::size_t looked_at = 0, wanted = kLine;; wanted *= 4) {
    line = source_.peek(wanted);
    const std::size_t end = line.find('\n', looked_at);
    const bool ends = end != std::string_view::npos, is_last = line.size() == source_.left();
    looked_at = ends ? end : line.size();
    if (looked_at > kLongest) {
      ++line_;
      fail("a line of more than " + std::to_string(kLongest) + " bytes: this is no text");
    }
    if (!ends && !is_last) continue;
    source_.skip(ends ? end + 1 : line.size());
    line = line.substr(0, end);
    break;
  }
  ++line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::optional<std::string_view> TextLines::next_with_content() {
  while (const auto line = next()) {
    std::string_view content = line->substr(0, line->find('#'));
    skip_separators(content);
    if (!content.empty()) return content;
  }
  return std::nullopt;
}

void TextLines::fail(const std::string& what) const {
  throw std::runtime_error(path_ + (line_ > 0 ? ":" + std::to_string(line_) : "") + ": " + what);
}

void TextLines::parse_numbers(std::string_view text, std::vector<double>& numbers) const {
  numbers.clear();
  for (skip_separators(text); !text.empty(); skip_separators(text)) {
    const char* begin = text.data();
    const char* const end = begin + text.size();
    if (*begin == '+') ++begin;  // from_chars does not accept a plus sign
    double value = 0;
    const auto result = std::from_chars(begin, end, value);
    if ((result.ptr != end && !is_separator(*result.ptr)) || result.ec == std::errc::invalid_argument)
      fail(quoted(take_word(text)) + " is not a number");
    if (result.ec == std::errc::result_out_of_range) {
      // Too large or too small for a double; from_chars does not say which, strtod does.
      value = std::strtod(std::string(begin, result.ptr).c_str(), nullptr);
    }
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(result.ptr - text.data()));
  }
}

void TextLines::parse_finite(std::string_view text, std::vector<double>& numbers) const {
  parse_numbers(text, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i])) fail("number " + std::to_string(i + 1) + " of the line is not finite");
}

std::string quoted(std::string_view word) {
  std::string text = "'";
  for (char c : word.substr(0, 40)) text += c >= 0x20 && c < 0x7f ? c : '?';
  return text + (word.size() > 40 ? "...'" : "'");
}

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (auto word = take_word(text); !word.empty(); word = take_word(text)) words.push_back(word);
  return words;
}

std::optional<std::uint64_t> parse_unsigned(std::string_view word) {
  std::uint64_t value = 0;
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  if (result.ec != std::errc() || result.ptr != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace scanlock
