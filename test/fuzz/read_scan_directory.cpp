// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "fuzz.hpp"
#include "io/scan_directory.hpp"

using namespace scanlock;

namespace {

/// A directory of two scans of two points each.
const std::filesystem::path& directory() {
  static const std::filesystem::path path = [] {
    std::string name = (std::filesystem::temp_directory_path() / "scanlock_fuzz_XXXXXX").string();
    fuzz::require(mkdtemp(name.data()) != nullptr);
    std::filesystem::create_directory(std::filesystem::path(name) / "ptime");
    for (const char* scan : {"000000.bin", "000001.bin"})
      std::ofstream(std::filesystem::path(name) / scan, std::ios::binary) << std::string(32, 'x');
    return std::filesystem::path(name);
  }();
  return path;
}

void read_with(const std::string& times, const std::string& point_times) {
  std::ofstream(directory() / "times.txt", std::ios::binary) << times;
  std::ofstream(directory() / "ptime/000000.f32", std::ios::binary) << point_times;
  fuzz::allow_errors([] {
    const ScanDirectory scans(directory().string(), {});
    for (std::size_t i = 0; i < scans.size(); ++i) scans.read(i);
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(data), size);
  read_with(input, std::string(8, '\0'));
  read_with("1.0\n1.1\n", input);
  return 0;
}
