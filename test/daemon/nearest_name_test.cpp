// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/nearest_name.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

TEST_CASE("the nearest name begins with the input or differs in few letters; otherwise there is none") {
  const std::vector<std::string> names = {"voxel", "output", "json", "up"};
  CHECK(nearest_name("voxl", names) == "voxel");
  CHECK(nearest_name("oxvel", names) == "voxel");
  CHECK(nearest_name("out", names) == "output");
  CHECK(nearest_name("jsno", names) == "json");
  CHECK(nearest_name("frobnicate", names) == "");
  CHECK(nearest_name("xy", names) == "");
  CHECK(nearest_name("", names) == "");
}
