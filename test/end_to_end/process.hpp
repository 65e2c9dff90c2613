// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace scanlock::test {

/// A folder that is removed at the end of the test.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// A program and its arguments.
using CommandLine = std::vector<std::string>;
std::string joined(const CommandLine& command);

/// A running program; the destructor kills it. Its standard output and standard error are kept.
class Process {
 public:
  /// The first word of `command` is a path, the name of a program of this project, or that of a program on
  /// the PATH.
  Process(const TemporaryFolder& folder, const CommandLine& command);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const;
  /// The exit code, or 128 plus the signal that ended the program; nothing when it still runs after
  /// `patience`.
  std::optional<int> wait(std::chrono::milliseconds patience);
  std::string output() const;  ///< standard output so far
  std::string errors() const;  ///< standard error so far

 private:
  pid_t pid_ = -1;
  std::optional<int> code_;
  std::string output_path_, error_path_;
};

/// Runs a program to its end (at most 120 s).
struct Result {
  int code = -1;
  std::string output, errors;
};
Result run(const TemporaryFolder& folder, const CommandLine& command);

std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& text);

}  // namespace scanlock::test
