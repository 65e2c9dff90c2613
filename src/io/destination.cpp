// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/destination.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace scanlock {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // Linux's own limit

Destination::Kind kind_of(const fs::path& path) {
  const fs::file_status status = fs::status(path);
  if (!fs::exists(status)) return Destination::Kind::kNothing;
  if (fs::is_directory(status)) return Destination::Kind::kDirectory;
  return fs::is_regular_file(status) ? Destination::Kind::kFile : Destination::Kind::kSpecial;
}

Destination followed(const std::string& name) {
  fs::path path = fs::absolute(name);
  for (int links = 0; links < kMostLinks; ++links) {
    const fs::path folder = fs::weakly_canonical(path.parent_path());
    path = folder / path.filename();
    // /dev/stdout and /dev/fd/N are links into /proc; their target is already open.
    if (folder.string().rfind("/proc/", 0) == 0) return {path.string(), Destination::Kind::kSpecial};
    if (!fs::is_symlink(fs::symlink_status(path))) return {path.string(), kind_of(path)};
    path = folder / fs::read_symlink(path);
  }
  throw std::runtime_error(name + ": " + std::strerror(ELOOP));
}

}  // namespace

Destination destination_of(const std::string& name) {
  try {
    return followed(name);
  } catch (const fs::filesystem_error& error) {
    throw std::runtime_error(name + ": " + error.code().message());
  }
}

bool same_file(const Destination& a, const Destination& b) {
  std::error_code error;
  return a.path == b.path || fs::equivalent(a.path, b.path, error);
}

}  // namespace scanlock
