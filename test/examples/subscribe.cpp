// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// subscribe [URL]: prints what scanlockd publishes: time, state, epoch and position of each scan. The URL may
// be that of a log. README.md shows it from here on.
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <scanlock/lcmtypes/scanlock/odometry_t.hpp>

void print(const lcm::ReceiveBuffer*, const std::string&, const scanlock::odometry_t* scan, int) {
  const bool tracking = scan->state == scanlock::odometry_t::TRACKING;
  std::printf("%.6f %s epoch %d  %.3f %.3f %.3f\n", 1e-6 * double(scan->utime),
              tracking ? "tracking" : "not tracking", scan->epoch, scan->pos[0], scan->pos[1], scan->pos[2]);
}

int main(int argc, char** argv) {
  lcm::LCM lcm(argc > 1 ? argv[1] : "udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) return 1;
  lcm.subscribeFunction("SCANLOCK_ODOMETRY", print, 0);
  while (lcm.handle() == 0) continue;
}
