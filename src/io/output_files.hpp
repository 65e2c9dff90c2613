// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace scanlock {

/// All that a run of a program reads and writes, as it was named; an empty name stands for nothing.
struct RunFiles {
  std::vector<std::string> inputs;  ///< files, and directories of scans
  std::vector<std::string> outputs;
  std::string output_directory;  ///< of scans
};

/// To be called before anything is opened for writing. Throws std::runtime_error, one sentence that names the
/// file, when a run would write over one of its inputs, write two outputs into one file, or has no folder to
/// write to; and, unless `force`, when an output is there already (a directory: when it is not empty). What
/// is no regular file (/dev/null, /dev/stdout, a FIFO) can be written by anybody at any time.
void check_outputs(const RunFiles& files, bool force);

}  // namespace scanlock
