// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "daemon/lcm_url.hpp"

namespace scanlock {

/// Queries of this host's network. LCM does not expose its sockets; callers find them by comparing
/// udp_sockets_on() before and after LCM opens them.

/// Descriptors of the UDP sockets of this process that are bound to `port`.
std::set<int> udp_sockets_on(int port);

/// Receive buffer of a socket in bytes, in the units of setsockopt() (getsockopt() returns the double).
int granted_receive_buffer(int fd);
/// Sets a receive buffer beyond net.core.rmem_max, which the kernel permits with CAP_NET_ADMIN only; a
/// failure is ignored.
void force_receive_buffer(int fd, int bytes);

/// Datagrams that the kernel dropped at this socket since it was opened; nothing when the number is not
/// available.
std::optional<std::int64_t> kernel_drops(int fd);

/// The number in a kernel setting such as "net/core/rmem_max"; nothing when it cannot be read.
std::optional<std::int64_t> kernel_setting(const std::string& path);

struct MulticastRoute {
  bool exists = false;
  bool on_loopback = false;
  std::string local_address;  ///< source address of packets to the group
};
MulticastRoute multicast_route(const MulticastEndpoint& endpoint);

bool loopback_is_up();

/// When multicast cannot work at present, one sentence with the command that corrects it; otherwise empty.
std::string multicast_fault(const MulticastEndpoint& endpoint);

}  // namespace scanlock
