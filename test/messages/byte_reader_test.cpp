// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/byte_reader.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace scanlock;

TEST_CASE("numbers are big endian") {
  const std::vector<std::uint8_t> bytes = {0xff, 0xfe, 0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0, 0, 0, 0, 0};
  ByteReader reader(bytes.data(), bytes.size());
  CHECK(reader.read_i16("a") == -2);
  CHECK(reader.read_float("b") == 1.0f);
  CHECK(reader.read_double("c") == -2.0);
  reader.expect_end();
  CHECK(reader.ok());
}

TEST_CASE("a count is accepted only if the remaining bytes can hold its elements") {
  const std::vector<std::uint8_t> bytes = {0, 0, 0, 3, 1, 2, 3, 4, 5, 6};
  CHECK(ByteReader(bytes.data(), bytes.size()).read_count_i32("n", 2) == 3);
  ByteReader too_many(bytes.data(), bytes.size());
  CHECK(too_many.read_count_i32("n", 3) == 0);
  CHECK(too_many.fault() == DecodeFault::kTruncated);
  CHECK(too_many.error() == "`n` announces 3 elements of 3 bytes and 6 bytes are left");

  const std::vector<std::uint8_t> most = {0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 2};
  ByteReader overflowing(most.data(), most.size());  // 2^63 - 1 elements of 16 bytes: the product wraps
  CHECK(overflowing.read_count_i64("n", 16) == 0);
  CHECK(overflowing.fault() == DecodeFault::kTruncated);

  const std::vector<std::uint8_t> negative = {0xff, 0xff, 0xff, 0xff, 0};
  ByteReader below(negative.data(), negative.size());
  CHECK(below.read_count_i32("n", 1) == 0);
  CHECK(below.fault() == DecodeFault::kBadSize);
  CHECK(below.error() == "`n` is negative: -1");
}

TEST_CASE("after the first fault all values are zero, and the first fault stays") {
  const std::vector<std::uint8_t> bytes = {1, 2, 3};
  ByteReader reader(bytes.data(), bytes.size());
  CHECK(reader.read_i32("first") == 0);
  CHECK(reader.read_u8("second") == 0);
  CHECK(reader.read_bytes(1, "third").data == nullptr);
  CHECK(reader.read_string("fourth").empty());
  reader.expect_end();
  CHECK(reader.error() == "the message ends within `first`: it needs 4 bytes and 3 are left");
}

TEST_CASE("a string needs its final zero") {
  const std::vector<std::uint8_t> good = {0, 0, 0, 3, 'a', 'b', 0}, open = {0, 0, 0, 2, 'a', 'b'},
                                  none = {0, 0, 0, 0};
  ByteReader reader(good.data(), good.size());
  CHECK(reader.read_string("s") == "ab");
  CHECK(reader.bytes_left() == 0);
  ByteReader unterminated(open.data(), open.size());
  CHECK(unterminated.read_string("s").empty());
  CHECK(unterminated.fault() == DecodeFault::kBadSize);
  ByteReader empty(none.data(), none.size());
  empty.read_string("s");
  CHECK(empty.fault() == DecodeFault::kBadSize);
}
