// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

namespace scanlock {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180.0;  ///< radians

}  // namespace scanlock
