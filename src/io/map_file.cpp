// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/map_file.hpp"

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "io/atomic_file.hpp"
#include "io/byte_source.hpp"
#include "io/map_layout.hpp"
#include "io/map_reader.hpp"
#include "io/map_writer.hpp"

namespace scanlock {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 32;  // a cloud of 1e8 points takes up to 1.2 GB

}  // namespace

std::vector<std::uint8_t> encode_map(const SavedMap& map) {
  std::vector<std::uint8_t> bytes;
  encode_map(map, [&](std::string_view piece) { bytes.insert(bytes.end(), piece.begin(), piece.end()); });
  return bytes;
}

SavedMap decode_map(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  ByteSource source(bytes);
  return decode_map(source, name);
}

void check_map_path(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || std::filesystem::file_size(path, error) == 0) return;
  std::ifstream file(path, std::ios::binary);
  std::array<char, kMagic.size()> start{};
  file.read(start.data(), start.size());
  if (!file || std::memcmp(start.data(), kMagic.data(), kMagic.size()) != 0)
    throw std::runtime_error(path + ": exists and is not a scanlock map; it is not overwritten");
}

void write_map(const std::string& path, const SavedMap& map) {
  check_map_path(path);
  write_file_atomically(path, [&](const TakeBytes& take) { encode_map(map, take); });
}

SavedMap read_map(const std::string& path) {
  ByteSource source(path);
  if (source.left() > kMostBytes)
    throw std::runtime_error(path + ": has " + std::to_string(source.left()) +
                             " bytes, over the limit of 4 GiB for a map");
  return decode_map(source, path);
}

}  // namespace scanlock
