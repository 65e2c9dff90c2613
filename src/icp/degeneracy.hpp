// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "geometry/rigid.hpp"

namespace scanlock {

/// Which motions a scene leaves unobservable. From the Gauss-Newton matrix H = sum w j j^T of a
/// point-to-plane alignment, j = [n; p x n] in the body frame: its translation and rotation blocks are
/// decoupled by their Schur complements (a translation that a rotation can undo is not observed), and the
/// eigenvalues of each are put over the block's trace, so that 1/3 is a scene of walls in all directions and
/// 0 one that slides freely.
struct Degeneracy {
  double weakest_translation = 0;  ///< smallest eigenvalue over trace
  double weakest_rotation = 0;
  std::uint32_t axes = 0;  ///< bit 0..2: translation along body x y z, 3..5: rotation about x y z; those
                           ///< nearest to a weak direction
};
Degeneracy find_degeneracy(const Matrix6& information);

/// What an alignment may take for seen, where errors of normals make a part of H that holds back what slides
/// freely. Along a translation that has h of H, n of it noise, and p of the prediction, the alignment moved
/// by h / (p + h) of what the scan says; with the information i = h - 2 n that is surely real it would have
/// been i / (p + i).
struct Observed {
  Matrix6 motion;       ///< times what the alignment moved a pose from its prediction: what to take of it
  Matrix6 information;  ///< a square root of the share that is real: information^T H information is
};
/// `information`: of the scan, H over the variance of a residual; `noise`: the part of it that errors of the
/// normals make, as expected; `predicted`: covariance of the prediction. All in the body frame.
Observed observed(const Matrix6& information, const Matrix6& noise, const Matrix6& predicted);

}  // namespace scanlock
