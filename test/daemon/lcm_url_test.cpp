// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/lcm_url.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

using namespace scanlock;

namespace {

/// Sets LCM_DEFAULT_URL for one test case.
class Environment {
 public:
  explicit Environment(const char* value) { setenv("LCM_DEFAULT_URL", value, 1); }
  ~Environment() { unsetenv("LCM_DEFAULT_URL"); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
};

}  // namespace

TEST_CASE("without flag and environment the URL is multicast on this host with a large buffer") {
  const Environment environment("");
  CHECK(input_url({}) == "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=8388608");
  CHECK(output_url({}) == "udpm://239.255.76.67:7667?ttl=0");
}

TEST_CASE("the flag wins over the environment and a buffer in the URL over the configuration") {
  const Environment environment("udpm://239.255.76.67:7700?ttl=1");
  DaemonConfig config;
  CHECK(input_url(config) == "udpm://239.255.76.67:7700?ttl=1&recv_buf_size=8388608");
  CHECK(output_url(config) == "udpm://239.255.76.67:7700?ttl=1");
  config.url = "udpm://:7701?recv_buf_size=1000";
  CHECK(input_url(config) == config.url);
  CHECK(wanted_receive_buffer(input_url(config)) == 1000);
  config.url = "udpm://";
  CHECK(input_url(config) == "udpm://?recv_buf_size=8388608");
}

TEST_CASE("the URL of an input log is never used as the output URL") {
  const Environment environment("");
  DaemonConfig config;
  config.url = "file:///tmp/a.lcmlog?speed=0";
  CHECK(input_url(config) == config.url);
  CHECK(output_url(config) == kDefaultUrl);
  const Environment log_in_environment("file:///tmp/a.lcmlog");
  CHECK(output_url({}) == kDefaultUrl);
  config.out_url = "file:///tmp/b.lcmlog?mode=w";
  CHECK(output_url(config) == config.out_url);
}

TEST_CASE("the path of a log is the part of its URL between file:// and the options") {
  CHECK(log_url_path("file:///tmp/a.lcmlog?speed=0&mode=w") == "/tmp/a.lcmlog");
  CHECK(log_url_path("file://a.lcmlog") == "a.lcmlog");
  CHECK(log_url_path("udpm://239.255.76.67:7667?ttl=0") == "");
}

TEST_CASE("group and port are read as LCM reads them") {
  CHECK(multicast_endpoint("udpm://").port == 7667);
  CHECK(multicast_endpoint("udpm://?ttl=0").address == "239.255.76.67");
  CHECK(multicast_endpoint("udpm://239.1.2.3:99?ttl=0").address == "239.1.2.3");
  CHECK(multicast_endpoint("udpm://239.1.2.3:99?ttl=0").port == 99);
  CHECK_THROWS_AS(multicast_endpoint("udpm://239.1.2.3:99999"), ConfigError);
  CHECK_THROWS_AS(multicast_endpoint("udpm://239.1.2.3:x"), ConfigError);
}

TEST_CASE("channel names are literal") {
  CHECK(literal_pattern("LIDAR_2") == "LIDAR_2");
  CHECK(literal_pattern("/lidar#sensor_msgs.PointCloud2") == "/lidar\\#sensor_msgs\\.PointCloud2");
  CHECK(literal_pattern("a.*(b)") == "a\\.\\*\\(b\\)");
}

TEST_CASE("a URL that can never work is refused, and a well-formed URL of an unreachable host is accepted") {
  for (const char* url : {"udpm://239.255.76.67:7667?ttl=0", "udpm://", "udpm://?ttl=0", "tcpq://nobody:7700",
                          "file:///tmp/a.lcmlog?speed=0"})
    CHECK_NOTHROW(check_url(url));
  for (const char* url :
       {"", "LIDAR", "udp://239.255.76.67:7667", "udpm://239.255.76.67:99999", "udpm://192.168.1.4:7667",
        "udpm://robot:7667", "udpm://239.255.76.67", "udpm://:7701", "file://", "file://?speed=0",
        "file:///tmp/a.lcmlog?sped=0", "file:///tmp/a.lcmlog?mode=w&fast"}) {
    CAPTURE(url);
    CHECK_THROWS_AS(check_url(url), ConfigError);
  }
}
