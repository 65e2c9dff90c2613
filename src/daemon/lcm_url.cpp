// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/lcm_url.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "daemon/nearest_name.hpp"

namespace scanlock {
namespace {

bool starts_with(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

std::optional<int> parse_int(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string environment_or_default_url() {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  return environment != nullptr && *environment != '\0' ? environment : kDefaultUrl;
}

std::string with_receive_buffer(const std::string& url, int bytes) {
  if (!is_multicast_url(url) || url_option(url, "recv_buf_size")) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=" + std::to_string(bytes);
}

/// ADDRESS:PORT of udpm://ADDRESS:PORT?OPTIONS.
std::string multicast_network(const std::string& url) {
  const std::string rest = url.substr(std::strlen("udpm://"));
  return rest.substr(0, rest.find('?'));
}

/// LCM only warns of an unknown option of a log, so that a misspelt `speed` would play the log in real time.
void check_log_options(const std::string& url) {
  static const std::vector<std::string> kKnown = {"speed", "start_timestamp", "mode"};
  std::size_t begin = url.find('?');
  while (begin != std::string::npos) {
    const std::size_t end = url.find_first_of("&,", ++begin);
    const std::string option = url.substr(begin, end == std::string::npos ? end : end - begin);
    const std::string key = option.substr(0, option.find('='));
    if (!option.empty() && std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) {
      const std::string nearest = nearest_name(key, kKnown);
      throw ConfigError(
          url + ": " + key + " is no option of a log" +
          (nearest.empty() ? "; speed, start_timestamp and mode are" : "; did you mean " + nearest + "?"));
    }
    begin = end;
  }
}

}  // namespace

bool is_multicast_url(const std::string& url) {
  return starts_with(url, "udpm://");
}
bool is_log_url(const std::string& url) {
  return starts_with(url, "file://");
}

std::string log_url_path(const std::string& url) {
  if (!is_log_url(url)) return "";
  const std::string path = url.substr(std::strlen("file://"));
  return path.substr(0, path.find('?'));
}

void check_url(const std::string& url) {
  const std::size_t provider_end = url.find("://");
  const std::string provider = url.substr(0, provider_end);
  if (provider_end == std::string::npos || (provider != "udpm" && provider != "mpudpm" &&
                                            provider != "tcpq" && provider != "memq" && provider != "file"))
    throw ConfigError(url +
                      ": is no LCM URL; udpm://239.255.76.67:7667?ttl=0 (multicast), tcpq://HOST:PORT and "
                      "file://PATH are");
  if (is_log_url(url) && log_url_path(url).empty()) throw ConfigError(url + ": names no file");
  if (is_log_url(url)) check_log_options(url);
  if (!is_multicast_url(url)) return;
  const std::string network = multicast_network(url);
  // LCM takes both defaults for an empty network, and none for a part of it.
  if (!network.empty() && (network.front() == ':' || network.find(':') == network.npos))
    throw ConfigError(url + ": names no " + (network.front() == ':' ? "address" : "port") +
                      "; udpm://ADDRESS:PORT or udpm:// does");
  const MulticastEndpoint endpoint = multicast_endpoint(url);
  in_addr address{};
  if (inet_pton(AF_INET, endpoint.address.c_str(), &address) != 1)
    throw ConfigError(url + ": \"" + endpoint.address + "\" is no IPv4 address");
  const std::uint32_t first_byte = ntohl(address.s_addr) >> 24;
  if (first_byte < 224 || first_byte > 239)
    throw ConfigError(url + ": " + endpoint.address +
                      " is no multicast group (224.0.0.0 to 239.255.255.255)");
}

std::optional<std::string> url_option(const std::string& url, const std::string& key) {
  std::size_t begin = url.find('?');
  while (begin != std::string::npos) {
    const std::size_t end = url.find_first_of("&,", ++begin);
    const std::string option = url.substr(begin, end == std::string::npos ? end : end - begin);
    if (starts_with(option, key + "=")) return option.substr(key.size() + 1);
    begin = end;
  }
  return std::nullopt;
}

MulticastEndpoint multicast_endpoint(const std::string& url) {
  MulticastEndpoint endpoint;
  const std::string network = multicast_network(url);
  const std::size_t colon = network.find(':');
  if (!network.substr(0, colon).empty()) endpoint.address = network.substr(0, colon);
  if (colon != std::string::npos) {
    const auto port = parse_int(network.substr(colon + 1));
    if (!port || *port < 1 || *port > 65535) throw ConfigError(url + ": names no port from 1 to 65535");
    endpoint.port = *port;
  }
  return endpoint;
}

std::string input_url(const DaemonConfig& config) {
  return with_receive_buffer(config.url.empty() ? environment_or_default_url() : config.url,
                             config.receive_buffer_bytes);
}

std::string output_url(const DaemonConfig& config) {
  if (!config.out_url.empty()) return config.out_url;
  const std::string url =
      config.url.empty() || is_log_url(config.url) ? environment_or_default_url() : config.url;
  return is_log_url(url) && url_option(url, "mode").value_or("r") == "r" ? kDefaultUrl : url;
}

int wanted_receive_buffer(const std::string& url) {
  return parse_int(url_option(url, "recv_buf_size").value_or("0")).value_or(0);
}

std::string literal_pattern(const std::string& channel) {
  static const std::string kSpecial = "\\^$.|?*+()[]{}-#";
  std::string pattern;
  for (const char c : channel) {
    if (kSpecial.find(c) != std::string::npos) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

}  // namespace scanlock
