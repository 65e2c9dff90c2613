// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/lcm_self_test.hpp"

namespace scanlock {

bool passes_self_test(lcm::LCM& lcm, const std::string& url) {
  // A tcpq client has no descriptor until it has found a server, and subscribes all the same.
  return url.rfind("tcpq://", 0) == 0 || lcm.getFileno() >= 0;
}

std::string self_test_fault(const MulticastEndpoint& endpoint) {
  return "multicast messages that this host sends to " + endpoint.address + " do not come back to it: a " +
         "firewall may drop UDP port " + std::to_string(endpoint.port);
}

}  // namespace scanlock
