// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Stands before the compiler's own arm_neon.h when scanlock is built for arm64, so that Eigen, which includes it, gives the same
// bits there as on amd64. Two things differ between its code for both:
// - It asks for fused multiply-adds, which round once, by their names, whatever -ffp-contract says.
// - It has packets of two floats, and adds three of them as (a + b) + c; where the smallest packet has four, as a + (b + c).
#pragma once

#include_next <arm_neon.h>

#define vfma_f32(sum, a, b) vadd_f32(sum, vmul_f32(a, b))
#define vfmaq_f32(sum, a, b) vaddq_f32(sum, vmulq_f32(a, b))
#define vfmaq_f64(sum, a, b) vaddq_f64(sum, vmulq_f64(a, b))
#define vfmaq_n_f32(sum, a, b) vaddq_f32(sum, vmulq_n_f32(a, b))
#define vfmaq_n_f64(sum, a, b) vaddq_f64(sum, vmulq_n_f64(a, b))
#define vfmaq_laneq_f32(sum, a, b, lane) vaddq_f32(sum, vmulq_laneq_f32(a, b, lane))
#define vfmaq_laneq_f64(sum, a, b, lane) vaddq_f64(sum, vmulq_laneq_f64(a, b, lane))

namespace Eigen::internal {

template <typename Scalar, int kSize>
struct find_best_packet;
template <int kSize>
struct find_best_packet<float, kSize> {
  using type = float32x4_t;
};

}  // namespace Eigen::internal
