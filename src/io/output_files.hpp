// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace scanlock {

/// All files that a program run reads and writes, as named on the command line; empty names are ignored.
struct RunFiles {
  std::vector<std::string> inputs;  ///< files, or directories of scans
  std::vector<std::string> outputs;
  std::string output_directory;  ///< to write scans into
};

/// To be called before any file is opened for writing. Throws std::runtime_error, one sentence that names the
/// file, when a run would overwrite one of its inputs, write two outputs into one file, or has no writable
/// folder; and, unless `force`, when an output file exists already or an output directory is not empty.
/// Outputs that are not regular files (/dev/null, /dev/stdout, a FIFO) are always allowed.
void check_outputs(const RunFiles& files, bool force);

}  // namespace scanlock
