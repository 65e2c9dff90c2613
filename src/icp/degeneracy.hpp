// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "geometry/rigid.hpp"

namespace scanlock {

/// The motions that a scene leaves unobservable, from the Gauss-Newton matrix H = sum w j j^T of a
/// point-to-plane alignment, j = [n; p x n] in the body frame. Its translation and rotation blocks are
/// decoupled by their Schur complements (a translation that a rotation can undo is not observed), and the
/// eigenvalues of each are divided by the trace of the block: 1/3 for walls in all directions, 0 along a
/// direction in which the scene slides freely.
struct Degeneracy {
  double weakest_translation = 0;  ///< smallest eigenvalue over trace
  double weakest_rotation = 0;
  std::uint32_t axes = 0;  ///< degenerate axes; bit 0..2: translation along body x y z, 3..5: rotation about
                           ///< x y z
};
Degeneracy find_degeneracy(const Matrix6& information);

/// Corrections for the contribution of errors of the normals to H, which appears to constrain translations
/// that the scene leaves open. Along a translation with information h from the scan, of which n is expected
/// noise, and p from the prediction, the alignment moved by h / (p + h) of the measured displacement; with
/// the information i = h - 2 n, without the noise, it would have moved by i / (p + i).
struct Observed {
  Matrix6 motion;       ///< maps the alignment's displacement from the prediction to the part to accept
  Matrix6 information;  ///< r such that r^T H r is the information without the noise
};
/// `information`: of the scan, H over the variance of a residual; `noise`: the expected contribution of
/// errors of the normals to it; `predicted`: covariance of the prediction. All in the body frame, metres and
/// radians.
Observed observed(const Matrix6& information, const Matrix6& noise, const Matrix6& predicted);

}  // namespace scanlock
