// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "daemon/lcm_url.hpp"

namespace scanlock {

/// What this host's network says about itself. LCM hides its sockets; they are found by looking before and
/// after.

/// Descriptors of the UDP sockets of this process that are bound to `port`.
std::set<int> udp_sockets_on(int port);

/// Bytes of receive buffer that a socket has, as they were asked for (the kernel counts double).
int granted_receive_buffer(int fd);
/// Asks past the limit of net.core.rmem_max, which the kernel grants to CAP_NET_ADMIN only; failure is no
/// error.
void force_receive_buffer(int fd, int bytes);

/// Datagrams that the kernel dropped at this socket since it was opened; nothing when it cannot be read.
std::optional<std::int64_t> kernel_drops(int fd);

/// A kernel setting such as "net/core/rmem_max".
std::optional<std::int64_t> kernel_setting(const std::string& path);

struct MulticastRoute {
  bool exists = false;
  bool on_loopback = false;
  std::string local_address;  ///< where packets to the group would leave from
};
MulticastRoute multicast_route(const MulticastEndpoint& endpoint);

bool loopback_is_up();

/// One sentence with the command that mends it, when multicast cannot work now; empty when nothing is wrong.
std::string multicast_fault(const MulticastEndpoint& endpoint);

}  // namespace scanlock
