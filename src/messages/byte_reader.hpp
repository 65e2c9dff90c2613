// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "messages/decode_scan.hpp"

namespace scanlock {

/// A view of bytes that it does not own.
struct ByteView {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// Reads big-endian LCM data member by member, never past the end. The first error is kept as a fault with a
/// sentence naming the member; every later read returns zeros. A decoder may therefore read all members in
/// sequence and check ok() once, before it uses what it read (above all: before it allocates).
class ByteReader {
 public:
  ByteReader(const std::uint8_t* data, std::size_t size) : data_(data), size_(data == nullptr ? 0 : size) {}

  bool ok() const { return fault_ == DecodeFault::kNone; }
  DecodeFault fault() const { return fault_; }
  const std::string& error() const { return error_; }
  std::size_t bytes_left() const { return size_ - position_; }

  std::uint8_t read_u8(const char* member) { return static_cast<std::uint8_t>(read_big_endian<1>(member)); }
  std::int8_t read_i8(const char* member) { return static_cast<std::int8_t>(read_big_endian<1>(member)); }
  std::int16_t read_i16(const char* member) { return static_cast<std::int16_t>(read_big_endian<2>(member)); }
  std::int32_t read_i32(const char* member) { return static_cast<std::int32_t>(read_big_endian<4>(member)); }
  std::int64_t read_i64(const char* member) { return static_cast<std::int64_t>(read_big_endian<8>(member)); }
  float read_float(const char* member) {
    const auto bits = static_cast<std::uint32_t>(read_big_endian<4>(member));
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  double read_double(const char* member) {
    const std::uint64_t bits = read_big_endian<8>(member);
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  void read_doubles(double* values, std::size_t count, const char* member) {
    for (std::size_t i = 0; i < count; ++i) values[i] = read_double(member);
  }

  /// Reads a number of elements of at least `bytes_each` bytes each; a fault, and 0, when fewer bytes are
  /// left than they need.
  std::size_t read_count_i16(const char* member, std::size_t bytes_each);
  std::size_t read_count_i32(const char* member, std::size_t bytes_each);
  std::size_t read_count_i64(const char* member, std::size_t bytes_each);

  /// The next `size` bytes, not copied; a fault, and empty, when fewer are left.
  ByteView read_bytes(std::size_t size, const char* member);

  /// An LCM string: its length including the terminating zero, its characters, the zero. Not copied.
  std::string_view read_string(const char* member);

  /// To be called after the last member: bytes that remain are a fault.
  void expect_end();

  /// Records a fault found by the caller, unless an earlier one is recorded.
  void fail(DecodeFault fault, std::string error);

 private:
  template <std::size_t kBytes>
  std::uint64_t read_big_endian(const char* member) {
    if (!require(kBytes, member)) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < kBytes; ++i) value = value << 8 | data_[position_ + i];
    position_ += kBytes;
    return value;
  }
  bool require(std::size_t bytes, const char* member) {
    if (ok() && bytes <= bytes_left()) return true;
    if (ok()) fail_truncated(bytes, member);
    return false;
  }
  void fail_truncated(std::size_t bytes, const char* member);
  std::size_t checked_count(std::int64_t count, const char* member, std::size_t bytes_each);

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t position_ = 0;
  DecodeFault fault_ = DecodeFault::kNone;
  std::string error_;
};

}  // namespace scanlock
