// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/scan_directory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include "io/byte_source.hpp"
#include "io/cloud_columns.hpp"
#include "io/cloud_file.hpp"
#include "io/file_bytes.hpp"
#include "io/text_lines.hpp"

namespace scanlock {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxSeconds = 9e12;  // keeps microseconds within an int64

bool is_scan_extension(const std::string& extension) {
  return extension == ".bin" || extension == ".pcd" || extension == ".ply";
}

/// The number at the end of the name of a scan file; nothing for any other file.
std::optional<std::uint64_t> scan_number(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!is_scan_extension(extension)) return std::nullopt;
  const std::string stem = path.stem().string();
  const std::size_t last_other = stem.find_last_not_of("0123456789");
  return parse_unsigned(std::string_view(stem).substr(last_other == std::string::npos ? 0 : last_other + 1));
}

std::vector<double> read_times(const std::string& path) {
  ByteSource source(path);
  TextLines lines(path, source);
  std::vector<double> times, numbers;
  while (const auto line = lines.next_with_content()) {
    lines.parse_finite(*line, numbers);
    if (numbers.size() != 1) lines.fail("a line is one time in seconds");
    if (std::abs(numbers[0]) > kMaxSeconds) lines.fail("the time is out of range; times are in seconds");
    if (!times.empty() && numbers[0] <= times.back()) lines.fail("the time is not after the one before");
    times.push_back(numbers[0]);
  }
  return times;
}

std::vector<float> read_point_times(const std::string& path, std::size_t points) {
  const auto bytes = read_file_bytes(path);
  if (bytes.size() != 4 * points)
    throw std::runtime_error(path + ": " + std::to_string(bytes.size()) + " bytes for " +
                             std::to_string(points) + " points; it must hold a float32 for each");
  std::vector<float> times(points);
  for (std::size_t i = 0; i < points; ++i)
    times[i] = static_cast<float>(read_scalar(&bytes[4 * i], ScalarType::kFloat32, false));
  return times;
}

std::string numbered(std::size_t number) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%06zu", number);
  return buffer.data();
}

/// Removes the files that an earlier ScanDirectoryWriter with this extension wrote, and no others.
void remove_scans(const std::string& directory, const std::string& extension) {
  std::vector<fs::path> ours;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    const auto number = scan_number(entry.path());
    const bool of_ours = is_scan_directory_name(entry.path().filename().string());
    if (of_ours && (!number || entry.path().extension() == extension))
      ours.push_back(entry.path());
    else if (number)
      throw std::runtime_error(directory + ": holds scans of other names (" +
                               entry.path().filename().string() + "); name another directory");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(directory) / "ptime", error)) {
    if (entry.path().extension() == ".f32") ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) {
    if (!fs::is_directory(path) && !fs::remove(path, error) && error)
      throw std::runtime_error(path.string() + ": cannot be removed: " + error.message());
  }
}

}  // namespace

ScanDirectory::ScanDirectory(const std::string& path, const Clock& clock) : path_(path) {
  list_scans();
  stamp(clock);
}

void ScanDirectory::list_scans() {
  std::error_code error;
  fs::directory_iterator directory(path_, error);
  if (error) throw std::runtime_error(path_ + ": cannot list the directory: " + error.message());
  std::vector<std::pair<std::uint64_t, std::string>> found;
  for (const fs::directory_entry& entry : directory)
    if (const auto number = scan_number(entry.path()))
      found.emplace_back(*number, entry.path().filename().string());
  if (found.empty())
    throw std::runtime_error(path_ +
                             ": no numbered .bin, .pcd or .ply scans there (000000.bin, 000001.bin, ..)");
  std::sort(found.begin(), found.end());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && found[i].first == found[i - 1].first)
      throw std::runtime_error(path_ + ": " + found[i - 1].second + " and " + found[i].second +
                               " have the same number; move one of them away");
    scans_.push_back(found[i].second);
  }
}

void ScanDirectory::stamp(const Clock& clock) {
  const std::string times_path = (fs::path(path_) / "times.txt").string();
  std::vector<double> times;
  if (fs::exists(times_path)) {
    times = read_times(times_path);
    if (times.size() != scans_.size())
      throw std::runtime_error(times_path + ": " + std::to_string(times.size()) + " times for " +
                               std::to_string(scans_.size()) + " scans; there must be one for each");
  }
  const bool stands_alone = !times.empty() && times.front() > 0;
  const std::int64_t zero = clock.zero_utime < 0 && stands_alone ? 0 : clock.first_utime();
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const double time = times.empty() ? static_cast<double>(i) * clock.period_s : times[i];
    utimes_.push_back(zero + std::llround(time * 1e6));
  }
}

Scan ScanDirectory::read(std::size_t index) const {
  const fs::path file = fs::path(path_) / scans_[index];
  Scan scan;
  scan.utime = utimes_[index];
  scan.points = read_cloud(file.string());
  const fs::path point_times = fs::path(path_) / "ptime" / file.stem().concat(".f32");
  if (fs::exists(point_times)) scan.points.time = read_point_times(point_times.string(), scan.points.size());
  return scan;
}

bool is_scan_directory_name(const std::string& name) {
  const fs::path path = name;
  const std::string stem = path.stem().string();
  const bool numbered_as_here = stem.size() >= 6 && stem.find_first_not_of("0123456789") == std::string::npos;
  return name == "times.txt" || name == "ptime" ||
         (numbered_as_here && is_scan_extension(path.extension().string()));
}

ScanDirectoryWriter::ScanDirectoryWriter(const std::string& path, bool overwrite,
                                         const std::string& extension)
    : path_(path), extension_(extension) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw std::runtime_error(path_ + ": cannot make the directory: " + error.message());
  if (overwrite)
    remove_scans(path_, extension_);
  else if (!fs::is_empty(path_, error) || error)
    throw std::runtime_error(path_ + ": the directory is not empty; name a new one");
}

void ScanDirectoryWriter::write(const Scan& scan) {
  const fs::path directory(path_);
  const std::string name = numbered(count_++);
  write_cloud((directory / (name + extension_)).string(), scan.points);
  if (scan.points.has_times() && extension_ == ".bin") {
    std::error_code error;
    fs::create_directories(directory / "ptime", error);
    if (error) throw std::runtime_error((directory / "ptime").string() + ": " + error.message());
    std::string bytes;
    append_rows(bytes, {{"time", &scan.points.time}});
    write_file_bytes((directory / "ptime" / (name + ".f32")).string(), bytes);
  }
  std::array<char, 64> line{};
  const std::int64_t magnitude = std::abs(scan.utime);
  std::snprintf(line.data(), line.size(), "%s%lld.%06lld\n", scan.utime < 0 ? "-" : "",
                static_cast<long long>(magnitude / 1000000), static_cast<long long>(magnitude % 1000000));
  times_ += line.data();
}

void ScanDirectoryWriter::close() {
  write_file_bytes((std::filesystem::path(path_) / "times.txt").string(), times_);
}

}  // namespace scanlock
