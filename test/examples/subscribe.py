# Copyright (c) 2026 The scanlock authors
# SPDX-License-Identifier: MIT
# subscribe.py [URL]: the same as subscribe.cpp in Python, with the module lcm. README.md shows it from here on.
import sys
import lcm
from scanlock import odometry_t


def show(channel, data):
    scan = odometry_t.decode(data)
    state = "tracking" if scan.state == scan.TRACKING else "not tracking"
    print("%.6f %s epoch %d  %.3f %.3f %.3f" % (1e-6 * scan.utime, state, scan.epoch, *scan.pos))


lc = lcm.LCM(sys.argv[1] if len(sys.argv) > 1 else "udpm://239.255.76.67:7667?ttl=0")
lc.subscribe("SCANLOCK_ODOMETRY", show)
while True:
    lc.handle()
