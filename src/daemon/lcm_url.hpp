// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "daemon/config.hpp"

namespace scanlock {

/// Multicast on this host only: scans are too large for a network nobody asked about.
inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

struct MulticastEndpoint {
  std::string address = "239.255.76.67";
  int port = 7667;
};

/// What a URL asks for, as LCM itself reads it: PROVIDER://NETWORK?KEY=VALUE&KEY=VALUE.
bool is_multicast_url(const std::string& url);
bool is_log_url(const std::string& url);           ///< file://, for reading or writing
std::string log_url_path(const std::string& url);  ///< of a log; empty for another URL
/// Throws ConfigError, with what is wrong, for a URL that can never work on any network: an unknown provider,
/// no address, an address that is no multicast group, a port that is none. A host that cannot be reached may
/// come.
void check_url(const std::string& url);
std::optional<std::string> url_option(const std::string& url, const std::string& key);
/// Throws ConfigError when the port is none.
MulticastEndpoint multicast_endpoint(const std::string& url);

/// The URL with which to receive: the configured one, else LCM_DEFAULT_URL, else kDefaultUrl; on multicast
/// with the configured receive buffer asked for, unless the URL asks for one.
std::string input_url(const DaemonConfig& config);
/// The URL with which to publish: `out_url`, else as for the input; never the log that is read.
std::string output_url(const DaemonConfig& config);
/// Bytes of receive buffer that a URL asks for; 0 when it asks for none.
int wanted_receive_buffer(const std::string& url);

/// LCM subscribes by regular expression: one that matches exactly this channel.
std::string literal_pattern(const std::string& channel);

}  // namespace scanlock
