// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <future>
#include <vector>

#include "daemon/scan_slot.hpp"

using namespace scanlock;

TEST_CASE("a new value replaces a value that was not taken") {
  Slot<int> slot;
  CHECK_FALSE(slot.replace(1));
  CHECK(slot.replace(2));
  CHECK(slot.replace(3));
  CHECK(slot.take() == 3);
  CHECK_FALSE(slot.replace(4));
}

TEST_CASE("put loses nothing and keeps the order") {
  Slot<int> slot;
  auto giver = std::async(std::launch::async, [&] {
    for (int i = 0; i < 1000; ++i) slot.put(i);
    slot.finish();
  });
  std::vector<int> taken;
  while (const auto value = slot.take()) taken.push_back(*value);
  giver.get();
  REQUIRE(taken.size() == 1000);
  for (int i = 0; i < 1000; ++i) CHECK(taken[static_cast<std::size_t>(i)] == i);
}

TEST_CASE("closing wakes a waiting taker and a waiting giver, and drops the stored value") {
  Slot<int> empty, full;
  full.replace(1);
  auto taker = std::async(std::launch::async, [&] { return empty.take().has_value(); });
  auto giver = std::async(std::launch::async, [&] { return full.put(2); });
  empty.close();
  full.close();
  CHECK_FALSE(taker.get());
  CHECK_FALSE(giver.get());
  CHECK_FALSE(full.take().has_value());
}

TEST_CASE("the stored value can still be taken after finish") {
  Slot<int> slot;
  slot.replace(7);
  slot.finish();
  CHECK(slot.take() == 7);
  CHECK_FALSE(slot.take().has_value());
}
