// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/config.hpp"

namespace scanlock {

/// One thing the doctor looked at.
struct Finding {
  enum class Grade {
    kGood,
    kNote,
    kFault
  };  ///< a note is worth knowing; with a fault, no or not all scans come
  Grade grade = Grade::kGood;
  std::string name;    ///< short and fixed, for scripts
  std::string detail;  ///< a sentence
  std::string remedy;  ///< the exact command that mends it; empty when there is none
};

struct HeardChannel {
  std::string name, type;  ///< the type's fingerprint when it is none of ours
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
  std::int64_t kernel_drops = 0;  ///< datagrams, during the echo

  bool good() const;
};

/// Looks at everything that stands between a scan and the daemon: the route, the receive buffer, 2 MB
/// messages to itself through the configured URL, and who else speaks there. Takes about three seconds.
/// Reads a log until each scan channel has carried a scan. Throws ConfigError for a URL that can never work.
DoctorReport examine(const DaemonConfig& config);

/// The report for people: a line a finding, the command that mends it below.
std::string print_report(const DoctorReport& report);

}  // namespace scanlock
