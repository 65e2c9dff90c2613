// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/inbox.hpp"

#include <doctest/doctest.h>

#include <future>
#include <string>
#include <vector>

using namespace scanlock;

namespace {

using TestInbox = Inbox<int, std::string>;

std::string word(const TestInbox::Item& item) {
  return std::holds_alternative<int>(item) ? std::to_string(std::get<int>(item))
                                           : std::get<std::string>(item);
}

/// Everything that can be taken, in order.
std::string drained(TestInbox& inbox) {
  inbox.finish();
  std::string words;
  while (const auto item = inbox.take()) words += word(*item) + " ";
  return words;
}

}  // namespace

TEST_CASE("a fresh scan replaces the old one and no command") {
  TestInbox inbox(8);
  CHECK_FALSE(inbox.replace(1));
  CHECK(inbox.post("save"));
  CHECK(inbox.replace(2));
  CHECK(inbox.post("reset"));
  CHECK(inbox.replace(3));
  CHECK(drained(inbox) == "save reset 3 ");
}

TEST_CASE("too many commands are refused and scans are not in their way") {
  TestInbox inbox(2);
  inbox.replace(1);
  CHECK(inbox.post("a"));
  CHECK(inbox.post("b"));
  CHECK_FALSE(inbox.post("c"));
  CHECK(drained(inbox) == "1 a b ");
}

TEST_CASE("in a replay scans and commands keep their order and none is lost") {
  TestInbox inbox(1000);
  auto giver = std::async(std::launch::async, [&] {
    for (int i = 0; i < 300; ++i) {
      inbox.put(i);
      if (i % 3 == 0) inbox.post("after" + std::to_string(i));
    }
    inbox.finish();
  });
  std::string words, expected;
  while (const auto item = inbox.take()) words += word(*item) + " ";
  giver.get();
  for (int i = 0; i < 300; ++i) {
    expected += std::to_string(i) + " ";
    if (i % 3 == 0) expected += "after" + std::to_string(i) + " ";
  }
  CHECK(words == expected);
}

TEST_CASE("closing wakes both sides and drops the scan and keeps accepted commands") {
  TestInbox empty(1), full(1);
  full.replace(1);
  full.post("save");
  auto taker = std::async(std::launch::async, [&] { return empty.take().has_value(); });
  auto giver = std::async(std::launch::async, [&] { return full.put(2); });
  empty.close();
  full.close();
  CHECK_FALSE(taker.get());
  CHECK_FALSE(giver.get());
  CHECK_FALSE(full.post("late"));
  full.replace(3);
  CHECK(drained(full) == "save ");
}
