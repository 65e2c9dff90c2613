// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/lcm_log.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace scanlock {
namespace {

// Header, big endian: u32 sync word, i64 event number, i64 utime, u32 channel size, u32 data size.
constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
constexpr std::array<std::uint8_t, 4> kSyncBytes = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeaderSize = 28;
constexpr std::uint64_t kMaxDataSize = 1u << 28;    // LCM_MAX_MESSAGE_SIZE
constexpr std::uint64_t kMaxChannelSize = 999;      // the longest that lcm-logplayer reads
constexpr std::size_t kMaxWrittenChannelSize = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr std::uint64_t kSearchChunk = 1u << 18;

std::uint64_t get_big_endian(const std::uint8_t* bytes, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = (value << 8) | bytes[i];
  return value;
}

void put_big_endian(std::uint64_t value, int count, std::uint8_t* bytes) {
  for (int i = count - 1; i >= 0; --i, value >>= 8) bytes[i] = static_cast<std::uint8_t>(value & 0xff);
}

std::string reason() {
  return errno != 0 ? std::strerror(errno) : "unknown error";
}

}  // namespace

std::uint64_t LogReader::Header::event_size() const {
  return kHeaderSize + channel_size + data_size;
}

LogReader::LogReader(const std::string& path) : path_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw std::runtime_error(path + ": no such log file");
  if (error) throw std::runtime_error(path + ": cannot open the log: " + error.message());
  if (!std::filesystem::is_regular_file(status))
    throw std::runtime_error(path + ": not a regular file, so it cannot be read as an LCM log");
  errno = 0;
  file_.open(path, std::ios::binary);
  if (!file_) throw std::runtime_error(path + ": cannot open the log: " + reason());
  file_size_ = std::filesystem::file_size(path, error);
  if (error) throw std::runtime_error(path + ": cannot tell the size of the log: " + error.message());
}

void LogReader::read_at(std::uint64_t offset, std::uint8_t* bytes, std::size_t count) {
  if (count == 0) return;
  if (offset != file_position_) file_.seekg(static_cast<std::streamoff>(offset));
  file_.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(count));
  if (!file_)
    throw std::runtime_error(path_ + ": cannot read " + std::to_string(count) + " bytes at byte " +
                             std::to_string(offset) + ": the file shrank or the disk failed");
  file_position_ = offset + count;
}

/// The header at `offset`, if a logger could have written it; its event may extend past the end of the file.
std::optional<LogReader::Header> LogReader::header_at(std::uint64_t offset) {
  if (file_size_ - offset < kHeaderSize) return std::nullopt;
  std::array<std::uint8_t, kHeaderSize> bytes{};
  read_at(offset, bytes.data(), bytes.size());
  if (get_big_endian(bytes.data(), 4) != kSyncWord) return std::nullopt;
  Header header{};
  header.number = static_cast<std::int64_t>(get_big_endian(bytes.data() + 4, 8));
  header.utime = static_cast<std::int64_t>(get_big_endian(bytes.data() + 12, 8));
  header.channel_size = get_big_endian(bytes.data() + 20, 4);
  header.data_size = get_big_endian(bytes.data() + 24, 4);
  if (header.channel_size == 0 || header.channel_size > kMaxChannelSize) return std::nullopt;
  if (header.data_size > kMaxDataSize) return std::nullopt;
  std::array<std::uint8_t, kMaxChannelSize> channel{};
  const auto present = std::min(header.channel_size, file_size_ - offset - kHeaderSize);
  read_at(offset + kHeaderSize, channel.data(), present);
  const auto is_control = [](std::uint8_t c) { return c < 0x20 || c == 0x7f; };
  if (std::any_of(channel.begin(), channel.begin() + static_cast<std::ptrdiff_t>(present), is_control))
    return std::nullopt;
  return header;
}

/// Whether an event may end at `offset`: the end of the file, or the (possibly cut) sync word of the next
/// event.
bool LogReader::boundary_at(std::uint64_t offset) {
  const std::size_t count = std::min<std::uint64_t>(kSyncBytes.size(), file_size_ - offset);
  std::array<std::uint8_t, 4> bytes{};
  read_at(offset, bytes.data(), count);
  return std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count), kSyncBytes.begin());
}

/// Whether fewer bytes are left than a header has, and they start like a header.
bool LogReader::only_a_piece_left() {
  return file_size_ - position_ < kHeaderSize && boundary_at(position_);
}

LogReader::Search LogReader::find_event(std::uint64_t from, std::uint64_t to) {
  Search found;
  std::vector<std::uint8_t> chunk;
  while (from + kHeaderSize <= to) {
    chunk.resize(std::min(kSearchChunk, to - from));
    read_at(from, chunk.data(), chunk.size());
    auto at = chunk.begin();
    while ((at = std::search(at, chunk.end(), kSyncBytes.begin(), kSyncBytes.end())) != chunk.end()) {
      const std::uint64_t offset = from + static_cast<std::uint64_t>(at++ - chunk.begin());
      const auto header = header_at(offset);
      if (!header) continue;
      if (header->event_size() <= file_size_ - offset) {
        found.fitting = offset;
        return found;
      }
      if (!found.cut) found.cut = offset;
    }
    if (chunk.size() == to - from) break;
    from += chunk.size() - (kSyncBytes.size() - 1);  // a sync word may straddle two chunks
  }
  return found;
}

/// Moves to the next place where a complete event begins; false when no complete event follows.
bool LogReader::resynchronise() {
  ++damaged_places_;
  const Search found = find_event(position_ + 1, file_size_);
  const std::uint64_t target = found.fitting.value_or(found.cut.value_or(file_size_));
  skipped_bytes_ += static_cast<std::int64_t>(target - position_);
  position_ = target;
  if (!found.fitting && found.cut) {
    truncated_ = true;
    position_ = file_size_;
  }
  return found.fitting.has_value();
}

std::optional<LogEvent> LogReader::next() {
  while (position_ < file_size_) {
    const auto header = header_at(position_);
    if (!header) {
      if (only_a_piece_left()) break;
      if (!resynchronise()) return std::nullopt;
      continue;
    }
    if (header->event_size() > file_size_ - position_) {
      // Either this event was cut by the end of the file, or its size is damaged and complete events follow.
      if (!find_event(position_ + 1, file_size_).fitting) break;
      resynchronise();
      continue;
    }
    const std::uint64_t end = position_ + header->event_size();
    // No event begins at `end`. If one begins inside this event, the size of this event is damaged.
    if (!boundary_at(end) && find_event(position_ + 1, end).fitting) {
      resynchronise();
      continue;
    }
    LogEvent event;
    event.number = header->number;
    event.utime = header->utime;
    event.channel.resize(header->channel_size);
    event.data.resize(header->data_size);
    read_at(position_ + kHeaderSize, reinterpret_cast<std::uint8_t*>(event.channel.data()),
            event.channel.size());
    read_at(end - header->data_size, event.data.data(), event.data.size());
    position_ = end;
    return event;
  }
  if (position_ < file_size_) truncated_ = true;
  position_ = file_size_;
  return std::nullopt;
}

void check_log(const std::string& path) {
  if (!LogReader(path).next()) throw std::runtime_error(path + ": holds no event of an LCM log");
}

LogWriter::LogWriter(const std::string& path, Mode mode) : path_(path) {
  errno = 0;
  file_.open(path, std::ios::binary | (mode == Mode::kAppend ? std::ios::app : std::ios::trunc));
  if (!file_) throw std::runtime_error(path + ": cannot create the log: " + reason());
}

void LogWriter::write(std::int64_t utime, const std::string& channel, const std::vector<std::uint8_t>& data) {
  if (channel.empty() || channel.size() > kMaxWrittenChannelSize)
    throw std::runtime_error(path_ + ": channel '" + channel + "' must have 1 to 63 characters");
  if (data.size() > kMaxDataSize)
    throw std::runtime_error(path_ + ": a message of " + std::to_string(data.size()) + " bytes on channel " +
                             channel + " is over LCM's limit of 256 MiB");
  std::array<std::uint8_t, kHeaderSize> header{};
  put_big_endian(kSyncWord, 4, header.data());
  put_big_endian(static_cast<std::uint64_t>(next_number_), 8, header.data() + 4);
  put_big_endian(static_cast<std::uint64_t>(utime), 8, header.data() + 12);
  put_big_endian(channel.size(), 4, header.data() + 20);
  put_big_endian(data.size(), 4, header.data() + 24);
  errno = 0;
  file_.write(reinterpret_cast<const char*>(header.data()), static_cast<std::streamsize>(header.size()));
  file_.write(channel.data(), static_cast<std::streamsize>(channel.size()));
  file_.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
  if (!file_) throw std::runtime_error(path_ + ": cannot write the log: " + reason());
  ++next_number_;
}

void LogWriter::close() {
  errno = 0;
  file_.close();
  if (!file_) throw std::runtime_error(path_ + ": cannot finish the log: " + reason());
}

}  // namespace scanlock
