// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/service_manager.hpp"

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>

#include "../io/temporary_directory.hpp"

using namespace scanlock;
using namespace std::chrono_literals;

namespace {

/// A stand-in for the service manager: a socket, and the environment variables that name it.
class Listener {
 public:
  Listener(std::string address, const char* watchdog_us) : socket_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    setenv("NOTIFY_SOCKET", address.c_str(), 1);
    setenv("WATCHDOG_USEC", watchdog_us, 1);
    if (address[0] == '@') address[0] = '\0';
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, address.data(), address.size());
    REQUIRE(bind(socket_, reinterpret_cast<const sockaddr*>(&at),
                 static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size())) == 0);
  }
  ~Listener() {
    close(socket_);
    for (const char* variable : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(variable);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// The next message, or nothing.
  std::string heard() const {
    std::array<char, 100> text{};
    const ssize_t size = recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
    return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "";
  }

 private:
  int socket_;
};

}  // namespace

TEST_CASE("the service manager receives READY=1, WATCHDOG=1 while the daemon works, and STOPPING=1") {
  const TemporaryDirectory directory;
  const ServiceManager::Clock::time_point begin = ServiceManager::Clock::now();
  for (const std::string& address : {directory / "notify", "@scanlock_test_" + std::to_string(getpid())}) {
    CAPTURE(address);
    const Listener listener(address, "4000000");
    ServiceManager manager;
    CHECK(listener.heard().empty());
    manager.ready();
    CHECK(listener.heard() == "READY=1");
    manager.alive(begin, 0s);
    CHECK(listener.heard() == "WATCHDOG=1");
    manager.alive(begin + 999ms, 0s);
    CHECK(listener.heard().empty());  // not again before a quarter of the period
    manager.alive(begin + 1s, 3s);
    CHECK(listener.heard() == "WATCHDOG=1");
    manager.alive(begin + 3s, 5s);
    CHECK(listener.heard().empty());  // work of 5 s, more than the period: the daemon hangs
    manager.alive(begin + 6s, 0s);
    CHECK(listener.heard() == "WATCHDOG=1");
    manager.stopping();
    CHECK(listener.heard() == "STOPPING=1");
  }
}

TEST_CASE("a watchdog of another process is ignored, and a missing service manager is no error") {
  const TemporaryDirectory directory;
  {
    const Listener listener(directory / "notify", "4000000");
    setenv("WATCHDOG_PID", "1", 1);
    ServiceManager manager;
    manager.alive(ServiceManager::Clock::now(), 0s);
    CHECK(listener.heard().empty());
  }
  for (const std::string& address :
       {std::string(), directory / "none", std::string("relative"), std::string(200, '/')}) {
    CAPTURE(address);
    setenv("NOTIFY_SOCKET", address.c_str(), 1);
    ServiceManager manager;
    CHECK_NOTHROW(manager.ready());
    CHECK_NOTHROW(manager.alive(ServiceManager::Clock::now(), 0s));
  }
  unsetenv("NOTIFY_SOCKET");
}
