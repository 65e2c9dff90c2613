// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace scanlock {

/// The axes that a scene has left open lately. After a long stretch without an axis a single scan that seems
/// to show it proves nothing: as many have to as did not before, up to some two seconds of them.
class OpenAxes {
 public:
  /// Takes the axes that an alignment left open (bits as in Degeneracy); those that are to be named with it.
  std::uint32_t note(std::uint32_t axes);

 private:
  std::uint32_t last_ = 0;  ///< that were open
  int scans_ = 0;           ///< that left some open, less those that did not
};

}  // namespace scanlock
