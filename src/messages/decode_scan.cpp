// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/decode_scan.hpp"

#include "messages/byte_reader.hpp"
#include "messages/fingerprints.hpp"
#include "messages/scan_types.hpp"

namespace scanlock {
namespace {

using Decoder = void (*)(ByteReader&, const DecodeLimits&, DecodedScan&);

Decoder decoder_of(std::uint64_t type) {
  switch (type) {
    case fingerprint::kPointcloud2:
      return decode_pointcloud2;
    case fingerprint::kRosPointCloud2:
      return decode_ros_pointcloud2;
    case fingerprint::kDrakePointCloud:
      return decode_drake_point_cloud;
    case fingerprint::kPointcloud:
      return decode_pointcloud;
    case fingerprint::kPlanarLidar:
      return decode_planar_lidar;
    case fingerprint::kMbotLidar:
      return decode_mbot_lidar;
    case fingerprint::kScanSector:
      return decode_scan_sector;
    default:
      return nullptr;
  }
}

DecodedScan faulty(DecodeFault fault, std::string error, std::string type = {}) {
  DecodedScan decoded;
  decoded.fault = fault;
  decoded.type = std::move(type);
  decoded.error = decoded.type.empty() ? std::move(error) : decoded.type + ": " + error;
  return decoded;
}

std::string unknown_type(std::uint64_t type) {
  if (const char* known = type_name(type)) return std::string(known) + " is no scan";
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (int shift = 60; shift >= 0; shift -= 4) hex += kDigits[type >> shift & 15];
  return "the fingerprint " + hex + " is of no scan type that scanlock reads";
}

}  // namespace

const char* to_string(DecodeFault fault) {
  switch (fault) {
    case DecodeFault::kNone:
      return "none";
    case DecodeFault::kTruncated:
      return "truncated";
    case DecodeFault::kUnknownType:
      return "unknown type";
    case DecodeFault::kBadSize:
      return "bad size";
    case DecodeFault::kBadField:
      return "bad field";
  }
  return "?";
}

DecodedScan decode_scan(const std::uint8_t* data, std::size_t size, const DecodeLimits& limits) {
  if (size > limits.max_message_bytes)
    return faulty(DecodeFault::kBadSize, "the message has " + std::to_string(size) +
                                             " bytes, over the limit of " +
                                             std::to_string(limits.max_message_bytes));
  if (data == nullptr || size < 8)
    return faulty(DecodeFault::kTruncated,
                  "the message has " + std::to_string(size) + " bytes, too few for a fingerprint");
  const std::uint64_t type = message_fingerprint(data, size);
  const Decoder decode = decoder_of(type);
  if (decode == nullptr) return faulty(DecodeFault::kUnknownType, unknown_type(type));

  DecodedScan decoded;
  decoded.type = type_name(type);
  ByteReader reader(data + 8, size - 8);
  decode(reader, limits, decoded);
  if (!reader.ok()) return faulty(reader.fault(), reader.error(), decoded.type);
  return decoded;
}

}  // namespace scanlock
