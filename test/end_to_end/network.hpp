// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace scanlock::test {

/// A network in which multicast works and no other program sends. Where the kernel permits it, this process
/// and its children move into a network namespace of their own; the host's network does not change.
class Network {
 public:
  /// With `route` false the namespace has no multicast route yet (see `add_route`).
  explicit Network(bool route = true);

  bool is_private() const { return private_; }
  /// The reason why programs cannot use LCM here; empty when they can.
  const std::string& lack() const { return lack_; }
  /// A udpm URL with a port that only this process uses.
  const std::string& url() const { return url_; }

  /// Brings the loopback up and routes multicast through it; only in a private network.
  void add_route();

 private:
  bool private_ = false;
  std::string lack_, url_;
};

/// The largest receive buffer that a socket of this user gets, in bytes.
int possible_receive_buffer();

}  // namespace scanlock::test
