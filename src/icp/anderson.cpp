// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/anderson.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace scanlock {

AndersonAcceleration::AndersonAcceleration(int window) : window_(std::clamp(window, 0, kMaxWindow)) {}

StateVector AndersonAcceleration::next(const StateVector& x, const StateVector& image) {
  const StateVector residual = image - x;
  StateVector accelerated = image;
  if (window_ > 0) {
    if (count_ == 0) {
      image_steps_.resize(x.size(), window_);
      residual_steps_.resize(x.size(), window_);
    } else {
      const int column = (count_ - 1) % window_;
      image_steps_.col(column) = image - last_image_;
      residual_steps_.col(column) = residual - last_residual_;
      const int used = std::min(count_, window_);
      // QR instead of the normal equations, which would square the condition number: the steps become nearly
      // parallel as the iteration converges.
      const Columns steps = residual_steps_.leftCols(used);
      Eigen::ColPivHouseholderQR<Columns> qr(steps);
      qr.setThreshold(1e-10);
      const Eigen::VectorXd theta = qr.solve(residual);
      accelerated -= image_steps_.leftCols(used) * theta;
      if (!accelerated.allFinite()) accelerated = image;
    }
  }
  ++count_;
  last_image_ = image;
  last_residual_ = residual;
  return accelerated;
}

}  // namespace scanlock
