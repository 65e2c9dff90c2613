// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "simulation/random.hpp"
#include "simulation/world.hpp"

namespace scanlock {

/// Decides which movable objects of a world have been moved since it was made. Uses random numbers of its
/// own, so that all other objects stand where they would without changes.
class Changes {
 public:
  Changes(std::uint64_t world_seed, const Visit& visit)
      : share_(visit.moved), random_(visit.seed.value_or(world_seed), 2) {}

  /// Whether the next movable object has been moved.
  bool next() { return share_ > 0 && random_.chance(share_); }
  Random& random() { return random_; }

 private:
  double share_;
  Random random_;
};

}  // namespace scanlock
