// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "daemon/config.hpp"

namespace scanlock {

/// Multicast on this host only: scans would load other hosts' network without their consent.
inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

struct MulticastEndpoint {
  std::string address = "239.255.76.67";
  int port = 7667;
};

/// Parts of a URL, as LCM itself parses it: PROVIDER://NETWORK?KEY=VALUE&KEY=VALUE.
bool is_multicast_url(const std::string& url);
bool is_log_url(const std::string& url);           ///< file://, for reading or writing
std::string log_url_path(const std::string& url);  ///< path of the log; empty for any other URL
/// Throws ConfigError with the reason for a URL that can never work on any network: an unknown provider, no
/// address, an address that is not a multicast group, an invalid port. A host that cannot be reached is no
/// error, since it may become reachable later.
void check_url(const std::string& url);
std::optional<std::string> url_option(const std::string& url, const std::string& key);
/// Throws ConfigError when the port is not a number from 1 to 65535.
MulticastEndpoint multicast_endpoint(const std::string& url);

/// The URL for receiving: the configured one, else LCM_DEFAULT_URL, else kDefaultUrl. For multicast, the
/// configured receive buffer is added unless the URL sets one.
std::string input_url(const DaemonConfig& config);
/// The URL for publishing: `out_url`, else as for the input; never the log that is read.
std::string output_url(const DaemonConfig& config);
/// Bytes of receive buffer that a URL sets; 0 when it sets none.
int wanted_receive_buffer(const std::string& url);

/// LCM subscribes by regular expression: an expression that matches exactly this channel.
std::string literal_pattern(const std::string& channel);

}  // namespace scanlock
