// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/host_network.hpp"

#include <arpa/inet.h>
#include <dirent.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>

namespace scanlock {
namespace {

/// A file descriptor that is closed on destruction.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

bool is_udp_on(int fd, int port) {
  int type = 0;
  socklen_t type_size = sizeof type;
  if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_DGRAM) return false;
  sockaddr_in address{};
  socklen_t size = sizeof address;
  return getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
         address.sin_family == AF_INET && ntohs(address.sin_port) == port;
}

}  // namespace

std::set<int> udp_sockets_on(int port) {
  std::set<int> found;
  const std::unique_ptr<DIR, int (*)(DIR*)> directory(opendir("/proc/self/fd"), closedir);
  if (!directory) return found;
  while (const dirent* entry = readdir(directory.get())) {
    const int fd = std::atoi(entry->d_name);
    if (fd > 2 && is_udp_on(fd, port)) found.insert(fd);
  }
  return found;
}

int granted_receive_buffer(int fd) {
  int doubled = 0;
  socklen_t size = sizeof doubled;
  return getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &doubled, &size) == 0 ? doubled / 2 : 0;
}

void force_receive_buffer(int fd, int bytes) {
  setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes);
}

std::optional<std::int64_t> kernel_drops(int fd) {
  struct stat status {};
  if (fstat(fd, &status) != 0) return std::nullopt;
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);  // the heading
  while (std::getline(table, line)) {
    // sl local remote st tx:rx tr:when retransmits uid timeout inode ref pointer drops
    std::istringstream fields(line);
    std::string skipped;
    for (int i = 0; i < 9; ++i) fields >> skipped;
    std::uint64_t inode = 0;
    std::int64_t drops = 0;
    std::string reference, pointer;
    if (fields >> inode >> reference >> pointer >> drops && inode == status.st_ino) return drops;
  }
  return std::nullopt;
}

std::optional<std::int64_t> kernel_setting(const std::string& path) {
  std::ifstream file("/proc/sys/" + path);
  std::int64_t value = 0;
  if (file >> value) return value;
  return std::nullopt;
}

MulticastRoute multicast_route(const MulticastEndpoint& endpoint) {
  MulticastRoute route;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(endpoint.port));
  if (inet_aton(endpoint.address.c_str(), &address.sin_addr) == 0) return route;
  const Descriptor probe(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  // connect() on a datagram socket sends nothing; it only makes the kernel look up the route.
  if (connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return route;
  sockaddr_in local{};
  socklen_t size = sizeof local;
  if (getsockname(probe.get(), reinterpret_cast<sockaddr*>(&local), &size) != 0) return route;
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &local.sin_addr, text, sizeof text);
  route.exists = true;
  route.local_address = text;
  // A route through the loopback may have no source address, since 127.0.0.1 is not valid for other hosts.
  route.on_loopback = local.sin_addr.s_addr == 0 || std::strncmp(text, "127.", 4) == 0;
  return route;
}

bool loopback_is_up() {
  const Descriptor probe(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request{};
  std::strncpy(request.ifr_name, "lo", IFNAMSIZ - 1);
  return ioctl(probe.get(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

std::string multicast_fault(const MulticastEndpoint& endpoint) {
  in_addr address{};
  if (inet_aton(endpoint.address.c_str(), &address) == 0 || !IN_MULTICAST(ntohl(address.s_addr))) {
    return endpoint.address + " is no multicast address (224.0.0.0 to 239.255.255.255)";
  }
  if (!loopback_is_up()) return "the loopback interface is down; run: ip link set lo up";
  if (!multicast_route(endpoint).exists) {
    return "there is no route to " + endpoint.address + "; run: ip route add 224.0.0.0/4 dev lo";
  }
  return "";
}

}  // namespace scanlock
