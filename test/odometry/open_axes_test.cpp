// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/open_axes.hpp"

#include <doctest/doctest.h>

#include <initializer_list>

using namespace scanlock;

TEST_CASE("an axis that was open for a moment is forgotten at once") {
  OpenAxes axes;
  CHECK(axes.note(0) == 0);
  CHECK(axes.note(1) == 1);
  CHECK(axes.note(33) == 33);
  CHECK(axes.note(0) == 0);
}

TEST_CASE("after a stretch without an axis it has to be seen for as long, but for two seconds at most") {
  for (const int stretch : {10, 15, 1000}) {
    CAPTURE(stretch);
    OpenAxes axes;
    for (int i = 0; i < stretch; ++i) axes.note(i + 1 < stretch ? 9 : 1);
    int named = 0;
    while (axes.note(0) == 1) ++named;
    CHECK(named == (stretch > 20 ? 15 : stretch - 5));
    CHECK(axes.note(0) == 0);
  }
}
