// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/byte_source.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace scanlock {
namespace {

constexpr std::size_t kPiece = 1u << 20;  // bytes

}  // namespace

ByteSource::ByteSource(const std::vector<std::uint8_t>& bytes)
    : size_(bytes.size()), window_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

ByteSource::ByteSource(const std::string& path) : file_(std::make_shared<const InputFile>(path)) {
  size_ = file_->size();
}

void ByteSource::skip(std::size_t count) {
  offset_ += count;
  if (count <= window_.size()) {
    window_.remove_prefix(count);
    return;
  }
  window_ = {};
}

std::vector<std::uint8_t> ByteSource::take(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t at = 0; at < count;) {
    const std::string_view next = peek(1).substr(0, count - at);
    std::memcpy(&bytes[at], next.data(), next.size());
    at += next.size();
    skip(next.size());
  }
  return bytes;
}

void ByteSource::fill(std::size_t count) {
  std::vector<char> piece(std::min(std::max(count, kPiece), left()));
  std::copy(window_.begin(), window_.end(), piece.begin());
  const std::size_t held = window_.size();
  file_->read(offset_ + held, piece.size() - held, piece.data() + held);
  piece_ = std::move(piece);
  window_ = {piece_.data(), piece_.size()};
}

}  // namespace scanlock
