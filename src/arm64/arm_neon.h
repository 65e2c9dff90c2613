// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// When scanlock is built for arm64, this header is found before the compiler's own arm_neon.h. It makes
// Eigen, which includes arm_neon.h, compute the same bits on arm64 as on amd64. Eigen's code for arm64
// differs in two respects:
// - It calls the intrinsics for fused multiply-add, which round once, regardless of -ffp-contract; the macros
//   below replace them by a multiplication and an addition.
// - It has packets of two floats, and adds three floats as (a + b) + c; on amd64, where the smallest packet
//   has four floats, it adds them as a + (b + c). The specialisation below excludes packets of two floats.
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
