// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/lcm_url.hpp"
#include "fuzz.hpp"

using namespace scanlock;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string url(reinterpret_cast<const char*>(data), size);
  fuzz::allow_errors([&] { check_url(url); });
  if (is_multicast_url(url)) fuzz::allow_errors([&] { multicast_endpoint(url); });
  log_url_path(url);
  url_option(url, "ttl");
  wanted_receive_buffer(url);
  literal_pattern(url);
  return 0;
}
