// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/byte_reader.hpp"

namespace scanlock {

void ByteReader::fail(DecodeFault fault, std::string error) {
  if (!ok()) return;
  fault_ = fault;
  error_ = std::move(error);
}

void ByteReader::fail_truncated(std::size_t bytes, const char* member) {
  fail(DecodeFault::kTruncated, std::string("the message ends within `") + member + "`: it needs " +
                                    std::to_string(bytes) + " bytes and " + std::to_string(bytes_left()) +
                                    " are left");
}

std::size_t ByteReader::checked_count(std::int64_t count, const char* member, std::size_t bytes_each) {
  if (!ok()) return 0;
  if (count < 0) {
    fail(DecodeFault::kBadSize, std::string("`") + member + "` is negative: " + std::to_string(count));
    return 0;
  }
  // Divide rather than multiply: the product of a forged count may overflow.
  if (bytes_each > 0 && static_cast<std::uint64_t>(count) > bytes_left() / bytes_each) {
    fail(DecodeFault::kTruncated, std::string("`") + member + "` announces " + std::to_string(count) +
                                      " elements of " + std::to_string(bytes_each) + " bytes and " +
                                      std::to_string(bytes_left()) + " bytes are left");
    return 0;
  }
  return static_cast<std::size_t>(count);
}

std::size_t ByteReader::read_count_i16(const char* member, std::size_t bytes_each) {
  return checked_count(read_i16(member), member, bytes_each);
}
std::size_t ByteReader::read_count_i32(const char* member, std::size_t bytes_each) {
  return checked_count(read_i32(member), member, bytes_each);
}
std::size_t ByteReader::read_count_i64(const char* member, std::size_t bytes_each) {
  return checked_count(read_i64(member), member, bytes_each);
}

ByteView ByteReader::read_bytes(std::size_t size, const char* member) {
  if (!require(size, member)) return {};
  const ByteView view{data_ + position_, size};
  position_ += size;
  return view;
}

std::string_view ByteReader::read_string(const char* member) {
  const std::size_t length = read_count_i32(member, 1);
  if (!ok()) return {};
  if (length == 0) {
    fail(DecodeFault::kBadSize,
         std::string("the string `") + member + "` has no terminating zero: its length is 0");
    return {};
  }
  const ByteView view = read_bytes(length, member);
  if (!ok()) return {};
  if (view.data[length - 1] != 0) {
    fail(DecodeFault::kBadSize, std::string("the string `") + member + "` does not end with a zero");
    return {};
  }
  return {reinterpret_cast<const char*>(view.data), length - 1};
}

void ByteReader::expect_end() {
  if (ok() && bytes_left() > 0)
    fail(DecodeFault::kTruncated, std::to_string(bytes_left()) + " bytes follow the last member");
}

}  // namespace scanlock
