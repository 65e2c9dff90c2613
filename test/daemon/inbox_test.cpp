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

/// All items that can be taken, in order.
std::string drained(TestInbox& inbox) {
  inbox.finish();
  std::string words;
  while (const auto item = inbox.take()) words += word(*item) + " ";
  return words;
}

}  // namespace

TEST_CASE("a new scan replaces the waiting scan, and no command") {
  TestInbox inbox(8);
  CHECK_FALSE(inbox.replace(1));
  CHECK(inbox.post("save"));
  CHECK(inbox.replace(2));
  CHECK(inbox.post("reset"));
  CHECK(inbox.replace(3));
  CHECK(drained(inbox) == "save reset 3 ");
}

TEST_CASE("too many commands are refused, and a waiting scan does not count") {
  TestInbox inbox(2);
  inbox.replace(1);
  CHECK(inbox.post("a"));
  CHECK(inbox.post("b"));
  CHECK_FALSE(inbox.post("c"));
  CHECK(drained(inbox) == "1 a b ");
}

TEST_CASE("an offered scan is refused while another scan waits") {
  TestInbox inbox(8);
  CHECK(inbox.offer(1));
  CHECK_FALSE(inbox.offer(2));
  CHECK(inbox.post("reset"));
  CHECK_FALSE(inbox.offer(3));
  CHECK(drained(inbox) == "1 reset ");
}

TEST_CASE("closing wakes a waiting taker, drops the scan and keeps the accepted commands") {
  TestInbox empty(1), full(1);
  full.replace(1);
  full.post("save");
  auto taker = std::async(std::launch::async, [&] { return empty.take().has_value(); });
  empty.close();
  full.close();
  CHECK_FALSE(taker.get());
  CHECK_FALSE(full.post("late"));
  full.replace(3);
  CHECK(drained(full) == "save ");
}
