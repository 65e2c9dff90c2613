// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// subscribe [URL]: prints what scanlockd publishes: time, state, epoch and position of each scan. The URL may
// be that of a log.
#include <cstdio>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <scanlock/lcmtypes/scanlock/odometry_t.hpp>
#include <string>

namespace {

struct Printer {
  void print(const lcm::ReceiveBuffer*, const std::string&, const scanlock::odometry_t* message) {
    const bool tracking = message->state == scanlock::odometry_t::TRACKING;
    std::printf("%.6f %s epoch %d  %.3f %.3f %.3f\n", 1e-6 * static_cast<double>(message->utime),
                tracking ? "tracking" : "not tracking", message->epoch, message->pos[0], message->pos[1],
                message->pos[2]);
  }
};

}  // namespace

int main(int argc, char** argv) {
  lcm::LCM lcm(argc > 1 ? argv[1] : "udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) {
    std::cerr << "subscribe: no LCM at this URL\n";
    return 1;
  }
  Printer printer;
  lcm.subscribe("SCANLOCK_ODOMETRY", &Printer::print, &printer);
  while (lcm.handle() == 0) continue;
  return 0;
}
