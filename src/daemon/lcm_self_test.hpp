// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <lcm/lcm-cpp.hpp>
#include <string>

#include "daemon/lcm_url.hpp"

namespace scanlock {

/// Whether messages arrive from `url`; to be called before the first subscription. LCM 1.3.1 then sends a
/// multicast message to itself. If that does not arrive it fails after ten seconds, and a subscription is a
/// null pointer.
bool passes_self_test(lcm::LCM& lcm, const std::string& url);

/// One sentence for the case that the self test fails though there is a route.
std::string self_test_fault(const MulticastEndpoint& endpoint);

}  // namespace scanlock
