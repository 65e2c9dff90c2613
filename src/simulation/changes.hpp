// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "simulation/random.hpp"
#include "simulation/world.hpp"

namespace scanlock {

/// What of a world has been moved since it was made. Its draws leave those of the world alone, so that all
/// else stands where it would without it.
class Changes {
 public:
  Changes(std::uint64_t world_seed, const Visit& visit)
      : share_(visit.moved), random_(visit.seed.value_or(world_seed), 2) {}

  /// Whether the next thing has been.
  bool next() { return share_ > 0 && random_.chance(share_); }
  Random& random() { return random_; }

 private:
  double share_;
  Random random_;
};

}  // namespace scanlock
