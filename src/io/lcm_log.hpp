// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace scanlock {

/// One event of an LCM log, as lcm-logger writes it.
struct LogEvent {
  std::int64_t number = 0;
  std::int64_t utime = 0;  ///< microseconds, when the logger received it: never use it as the time of the data
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Reads an LCM event log to its end, whatever state it is in: damage is skipped to the next sync word and counted.
class LogReader {
 public:
  /// Throws std::runtime_error with a sentence that names the path when the file cannot be opened.
  explicit LogReader(const std::string& path);

  /// The next event, or nothing at the end of the file.
  std::optional<LogEvent> next();

  std::int64_t damaged_places() const { return damaged_places_; }  ///< times the reader had to resynchronise
  std::int64_t skipped_bytes() const { return skipped_bytes_; }
  bool truncated() const { return truncated_; }                    ///< the last event was cut short
  std::uint64_t position() const { return position_; }             ///< bytes read, for a progress bar
  std::uint64_t file_size() const { return file_size_; }

 private:
  std::ifstream file_;
  std::uint64_t position_ = 0, file_size_ = 0;
  std::int64_t damaged_places_ = 0, skipped_bytes_ = 0;
  bool truncated_ = false;
};

/// Writes an LCM event log that lcm-logplayer plays. Throws std::runtime_error naming the path when a write fails.
class LogWriter {
 public:
  explicit LogWriter(const std::string& path);
  void write(std::int64_t utime, const std::string& channel, const std::vector<std::uint8_t>& data);
  /// Flushes; throws when the disk refused. Call it before success is reported.
  void close();

 private:
  std::string path_;
  std::ofstream file_;
  std::int64_t next_number_ = 0;
};

}  // namespace scanlock
