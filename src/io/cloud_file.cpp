// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/cloud_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "io/cloud_formats.hpp"
#include "io/file_bytes.hpp"

namespace scanlock {
namespace {

struct Format {
  const char* extension;
  void (*parse)(const std::string& path, ByteSource& source, const PointSink& sink);
  std::string (*format)(const PointCloud& cloud);
};
constexpr std::array<Format, 5> kFormats = {{
    {".bin", parse_kitti_bin, format_kitti_bin},
    {".ply", parse_ply, format_ply},
    {".pcd", parse_pcd, format_pcd},
    {".xyz", parse_xyz, format_xyz},
    {".txt", parse_xyz, format_xyz},
}};

const Format& format_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const Format& format) { return extension == format.extension; });
  if (found != kFormats.end()) return *found;
  throw std::runtime_error(path + ": unknown kind of cloud; use .bin, .ply, .pcd, .xyz or .txt");
}

/// `part` and `all` must have the same optional attributes.
void append(const PointCloud& part, PointCloud* all) {
  for (const auto array : {&PointCloud::x, &PointCloud::y, &PointCloud::z, &PointCloud::nx, &PointCloud::ny,
                           &PointCloud::nz, &PointCloud::intensity, &PointCloud::time})
    (all->*array).insert((all->*array).end(), (part.*array).begin(), (part.*array).end());
}

}  // namespace

PointCloud read_cloud(const std::string& path) {
  PointCloud all;
  read_cloud(path, [&](PointCloud&& part) {
    if (all.empty())
      all = std::move(part);
    else
      append(part, &all);
  });
  return all;
}

void read_cloud(const std::string& path, const TakePoints& take,
                const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                const Eigen::Vector3d& offset) {
  const Format& format = format_of(path);
  ByteSource source(path);
  const auto take_and_tell = [&](PointCloud&& part) {
    take(std::move(part));
    if (progress) progress(source.offset(), source.offset() + source.left());
  };
  format.parse(path, source, {take_and_tell, offset});
}

void write_cloud(const std::string& path, const PointCloud& cloud) {
  write_file_bytes(path, format_of(path).format(cloud));
}

void check_cloud_path(const std::string& path) {
  format_of(path);
}

}  // namespace scanlock
