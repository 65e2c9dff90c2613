// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/scan_log.hpp"

#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>

#include "io/cloud_file.hpp"
#include "io/lcm_log.hpp"
#include "io/log_poses.hpp"
#include "messages/decode_scan.hpp"
#include "messages/encode_scan.hpp"

namespace scanlock {
namespace {

void append(std::vector<float>& to, const std::vector<float>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Joins the sectors of each scan; scans that arrive as one message pass through.
class SectorCollector {
 public:
  /// Passes on the scans that this message completes, and the scans that can no longer be completed.
  template <typename Take>
  void add(DecodedScan&& decoded, const Take& take) {
    if (pending_ && (decoded.sector_count == 1 || decoded.scan.utime != pending_->utime)) flush(take);
    if (!pending_) {
      pending_ = std::move(decoded.scan);
      expected_ = decoded.sector_count;
      received_ = 1;
    } else {
      PointCloud& points = pending_->points;
      const PointCloud& more = decoded.scan.points;
      append(points.x, more.x);
      append(points.y, more.y);
      append(points.z, more.z);
      append(points.intensity, more.intensity);
      append(points.time, more.time);
      ++received_;
    }
    if (received_ >= expected_) flush(take);
  }

  template <typename Take>
  void flush(const Take& take) {
    if (!pending_) return;
    if (received_ < expected_) ++incomplete_;
    take(*pending_);
    pending_.reset();
  }

  std::size_t incomplete() const { return incomplete_; }

 private:
  std::optional<Scan> pending_;
  int expected_ = 1, received_ = 0;
  std::size_t incomplete_ = 0;
};

std::string listed(const std::set<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += " " + name;
  return list.empty() ? " no events" : list;
}

/// Reads the scans of a channel for as long as `take` returns true. Throws std::runtime_error naming the file
/// and the channel when the channel holds no scan.
template <typename Take>
ScanConversion read_scans(const std::string& log_path, const std::string& channel, const Progress& progress,
                          const Take& take) {
  LogReader reader(log_path);
  ScanConversion result;
  bool more = true;
  const auto count = [&](const Scan& scan) {
    if (!more) return;
    ++result.scans;
    result.points += scan.points.size();
    more = take(scan);
  };
  SectorCollector collector;
  std::set<std::string> channels;
  while (const auto event = reader.next()) {
    channels.insert(event->channel);
    progress(reader.position(), reader.file_size());
    if (event->channel != channel) continue;
    DecodedScan decoded = decode_scan(event->data.data(), event->data.size());
    if (decoded.fault != DecodeFault::kNone) {
      if (result.rejected++ == 0) result.first_error = decoded.error;
      continue;
    }
    result.left_out_points += decoded.nonfinite_points;
    collector.add(std::move(decoded), count);
    if (!more) break;
  }
  collector.flush(count);
  result.incomplete = collector.incomplete();
  result.damage = damage_sentence(reader);
  if (result.scans > 0) return result;
  if (result.rejected > 0)
    throw std::runtime_error(log_path + ": channel " + channel + " holds no scan: " + result.first_error);
  throw std::runtime_error(log_path + ": nothing on channel " + channel + "; the log has" + listed(channels) +
                           " (choose with --channel)");
}

}  // namespace

std::vector<std::vector<std::uint8_t>> encode_scan(const Scan& scan, ScanMessage type, std::int32_t number) {
  ScanTags tags;
  tags.seq = number;
  switch (type) {
    case ScanMessage::kPointcloud2:
      return {encode_pointcloud2(scan, tags)};
    case ScanMessage::kPointcloud:
      return {encode_pointcloud(scan, tags)};
    case ScanMessage::kDrake:
      return {encode_drake_point_cloud(scan, tags)};
    case ScanMessage::kSectors:
      return encode_sectors(scan, tags);
    case ScanMessage::kPlanar:
      return {encode_planar_lidar(scan)};
  }
  return {};
}

ScanConversion directory_to_log(const ScanDirectory& directory, const std::string& log_path,
                                const std::string& channel, ScanMessage type, const Progress& progress) {
  LogWriter writer(log_path);
  ScanConversion result;
  for (std::size_t i = 0; i < directory.size(); ++i) {
    const Scan scan = directory.read(i);
    for (const auto& message : encode_scan(scan, type, static_cast<std::int32_t>(i)))
      writer.write(scan.utime, channel, message);
    ++result.scans;
    result.points += scan.points.size();
    progress(i + 1, directory.size());
  }
  writer.close();
  return result;
}

ScanConversion log_to_directory(const std::string& log_path, const std::string& channel,
                                const std::string& directory_path, const Progress& progress, bool overwrite,
                                const std::string& extension) {
  std::optional<ScanDirectoryWriter> writer;
  const ScanConversion result = read_scans(log_path, channel, progress, [&](const Scan& scan) {
    if (!writer) writer.emplace(directory_path, overwrite, extension);
    writer->write(scan);
    return true;
  });
  writer->close();
  return result;
}

ScanConversion log_to_cloud(const std::string& log_path, const std::string& channel,
                            const std::string& cloud_path, std::optional<std::size_t> number,
                            const Progress& progress) {
  const std::string on_channel = log_path + ": channel " + channel;
  std::optional<PointCloud> chosen;
  std::size_t seen = 0;
  ScanConversion result = read_scans(log_path, channel, progress, [&](const Scan& scan) {
    if (!number && seen > 0) {
      const std::string extension = std::filesystem::path(cloud_path).extension().string();
      throw std::runtime_error(
          on_channel + " holds more than one scan: --scan N writes one of them to " + cloud_path +
          " (the first is 0), a folder named as OUT takes all, with --format " + extension.substr(1) +
          "; scanlock-odometry LOG --map OUT.ply makes one cloud of all");
    }
    if (seen == number.value_or(0)) chosen = scan.points;
    ++seen;
    return !number || !chosen;
  });
  if (!chosen)
    throw std::runtime_error(on_channel + " holds " + std::to_string(seen) + " scans, the last is number " +
                             std::to_string(seen - 1));
  write_cloud(cloud_path, *chosen);
  result.scans = 1;
  result.points = chosen->size();
  return result;
}

}  // namespace scanlock
