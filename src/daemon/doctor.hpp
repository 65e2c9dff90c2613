// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/config.hpp"

namespace scanlock {

/// The result of one check.
struct Finding {
  enum class Grade { kGood, kNote, kFault };  ///< kNote: worth knowing; kFault: some or all scans are lost
  Grade grade = Grade::kGood;
  std::string name;    ///< short and fixed, for scripts
  std::string detail;  ///< a sentence
  std::string remedy;  ///< the exact command that corrects it; empty when there is none
};

struct HeardChannel {
  std::string name, type;  ///< the type's name, or its fingerprint when scanlock does not know it
  bool holds_scans = false;
  int messages = 0;
  std::size_t largest_bytes = 0;
};

struct DoctorReport {
  std::string url;
  std::vector<Finding> findings;
  std::vector<HeardChannel> heard;  ///< while the doctor listened
  double listened_s = 0;
  int recv_buf_wanted = 0, recv_buf_granted = 0;  ///< bytes
  std::int64_t rmem_max = 0;                      ///< bytes
  int echoes_sent = 0, echoes_received = 0;
  std::int64_t kernel_drops = 0;  ///< datagrams, during the echo check

  bool good() const;
};

/// Checks everything that scans pass through on their way to the daemon: the route, the receive buffer,
/// messages of 2 MB to itself through the configured URL, and the channels in use. Takes about three seconds.
/// Of a log, reads until each scan channel has carried a scan. Throws ConfigError for a URL that can never
/// work.
DoctorReport examine(const DaemonConfig& config);

/// The report as text: one line per finding, followed by the command that corrects it.
std::string print_report(const DoctorReport& report);

}  // namespace scanlock
