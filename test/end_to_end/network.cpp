// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "network.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace scanlock::test {
namespace {

sockaddr address_of(const char* dotted) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  inet_aton(dotted, &in.sin_addr);
  sockaddr out{};
  std::memcpy(&out, &in, sizeof in);
  return out;
}

/// A socket for ioctl requests only.
class Request {
 public:
  Request() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Request() { close(fd_); }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;
  int fd() const { return fd_; }
  void make(unsigned long what, void* argument) const {
    if (ioctl(fd_, what, argument) != 0 && errno != EEXIST) throw std::runtime_error(std::strerror(errno));
  }

 private:
  int fd_;
};

bool has_multicast_route() {
  const Request probe;
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(7667);
  inet_aton("239.255.76.67", &group.sin_addr);
  return connect(probe.fd(), reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0;
}

}  // namespace

Network::Network(bool route) {
  url_ = "udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 10000) + "?ttl=0";
  private_ = unshare(CLONE_NEWNET) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0;
  if (private_ && route) add_route();
  if (!private_ && !has_multicast_route()) {
    lack_ =
        "neither a network namespace of its own (root) nor a multicast route (ip route add 224.0.0.0/4 dev "
        "lo)";
  }
}

void Network::add_route() {
  const Request request;
  ifreq interface {};
  std::strncpy(interface.ifr_name, "lo", IFNAMSIZ - 1);
  request.make(SIOCGIFFLAGS, &interface);
  interface.ifr_flags = static_cast<short>(interface.ifr_flags | IFF_UP | IFF_MULTICAST);
  request.make(SIOCSIFFLAGS, &interface);
  char device[] = "lo";
  rtentry entry{};
  entry.rt_dst = address_of("224.0.0.0");
  entry.rt_genmask = address_of("240.0.0.0");
  entry.rt_gateway = address_of("0.0.0.0");
  entry.rt_flags = RTF_UP;
  entry.rt_dev = device;
  request.make(SIOCADDRT, &entry);
}

int possible_receive_buffer() {
  const Request probe;
  const int wanted = 8388608;
  setsockopt(probe.fd(), SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  setsockopt(probe.fd(), SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted);
  int doubled = 0;
  socklen_t size = sizeof doubled;
  getsockopt(probe.fd(), SOL_SOCKET, SO_RCVBUF, &doubled, &size);
  return doubled / 2;
}

}  // namespace scanlock::test
