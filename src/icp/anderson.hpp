// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

namespace scanlock {

/// Unknowns of an alignment: 6 for a rigid motion, 12 with its velocity, 18 with its acceleration, too.
/// Stored without dynamic memory.
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 18, 1>;

/// Anderson acceleration of a fixed-point iteration x <- G(x), equation 7.
class AndersonAcceleration {
 public:
  static constexpr int kMaxWindow = 5;  ///< m = 5 in all of the paper

  /// `window`: number of earlier iterates used, 0 (no acceleration) to kMaxWindow.
  explicit AndersonAcceleration(int window = kMaxWindow);

  /// Forgets the history.
  void reset() { count_ = 0; }

  /// Takes an iterate x and its image G(x), and returns the accelerated next iterate; without a history, the
  /// image itself.
  StateVector next(const StateVector& x, const StateVector& image);

 private:
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 18, kMaxWindow>;

  int window_;
  int count_ = 0;  ///< iterates passed to next() since reset()
  StateVector last_image_, last_residual_;
  Columns image_steps_, residual_steps_;  ///< G(j+1) - G(j) and F(j+1) - F(j), in ring buffers
};

}  // namespace scanlock
