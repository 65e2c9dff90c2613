// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/kidnap_evidence.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

TEST_CASE("each kind of evidence raises the log odds of a kidnap, and contradiction only up to its bound") {
  const KidnapEvidence none = {0, 0, 1};
  CHECK(kidnap_log_odds(none) < -5);
  CHECK(kidnap_log_odds({1, 0, 1}) > kidnap_log_odds({0.5, 0, 1}));
  CHECK(kidnap_log_odds({0, 0.2, 1}) > kidnap_log_odds({0, 0.1, 1}));
  CHECK(kidnap_log_odds({0, 0, 0.6}) > kidnap_log_odds({0, 0, 0.8}));
  CHECK(kidnap_log_odds({0, 0, 1.2}) == kidnap_log_odds(none));
  for (const double contradiction : {0.0, 0.1, 0.5, 1.0})
    CHECK(kidnap_log_odds({0.3, contradiction, 0.8}) <= most_kidnap_odds({0.3, 0, 0.8}));
  CHECK(kidnap_log_odds({0.3, 1, 0.8}) == most_kidnap_odds({0.3, 0, 0.8}));
}
