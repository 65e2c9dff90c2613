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
  std::int64_t utime =
      0;  ///< microseconds, time of receipt by the logger: never use it as the time of the data
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Reads an LCM event log to its end, even when it is damaged: the reader skips damage to the next sync word
/// that begins a plausible event, and counts it. It accepts a length only when the file is long enough for
/// it, so that a damaged byte cannot make it allocate more memory than the file has bytes.
class LogReader {
 public:
  /// Throws std::runtime_error with a sentence that names the path when the file cannot be opened or is not a
  /// regular file (a directory, a pipe).
  explicit LogReader(const std::string& path);

  /// The next event, or nothing at the end of the file. Throws std::runtime_error when a read from the disk
  /// fails.
  std::optional<LogEvent> next();

  std::int64_t damaged_places() const { return damaged_places_; }  ///< times the reader had to resynchronise
  std::int64_t skipped_bytes() const { return skipped_bytes_; }
  bool truncated() const { return truncated_; }         ///< the last event is incomplete
  std::uint64_t position() const { return position_; }  ///< bytes read, for a progress bar
  std::uint64_t file_size() const { return file_size_; }

 private:
  struct Header {
    std::int64_t number, utime;
    std::uint64_t channel_size, data_size;
    std::uint64_t event_size() const;
  };
  /// fitting: the first place where an event begins that lies completely within the file. cut: the first
  /// place, before `fitting` if there is one, where an event begins that the end of the file cuts short.
  struct Search {
    std::optional<std::uint64_t> fitting, cut;
  };

  void read_at(std::uint64_t offset, std::uint8_t* bytes, std::size_t count);
  std::optional<Header> header_at(std::uint64_t offset);
  bool boundary_at(std::uint64_t offset);
  bool only_a_piece_left();
  Search find_event(std::uint64_t from, std::uint64_t to);
  bool resynchronise();

  std::string path_;
  std::ifstream file_;
  std::uint64_t file_position_ = 0;
  std::uint64_t position_ = 0, file_size_ = 0;
  std::int64_t damaged_places_ = 0, skipped_bytes_ = 0;
  bool truncated_ = false;
};

/// Throws std::runtime_error naming the path when the file cannot be read or holds no event. Programs call it
/// before they open an output.
void check_log(const std::string& path);

/// Writes an LCM event log that lcm-logplayer can play. Throws std::runtime_error naming the path when a
/// write fails.
class LogWriter {
 public:
  enum class Mode : std::int8_t { kCreate, kAppend };
  explicit LogWriter(const std::string& path, Mode mode = Mode::kCreate);
  /// `utime`: microseconds. Throws for a channel name that is empty or longer than LCM's 63 characters, and
  /// for data of more than 256 MiB.
  void write(std::int64_t utime, const std::string& channel, const std::vector<std::uint8_t>& data);
  /// Flushes; throws when a write failed. Call it before reporting success.
  void close();

 private:
  std::string path_;
  std::ofstream file_;
  std::int64_t next_number_ = 0;
};

}  // namespace scanlock
