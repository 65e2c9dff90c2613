// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: rigid transforms, their exponential, logarithm and adjoint.
#pragma once

#include "geometry/rigid.hpp"
#include "scanlock/version.hpp"
