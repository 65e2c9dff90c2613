// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "messages/byte_reader.hpp"
#include "messages/decode_scan.hpp"

namespace scanlock {

/// One decoder per scan type, called by decode_scan() only. The reader is positioned after the fingerprint;
/// faults are recorded in it.
void decode_pointcloud2(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);
void decode_ros_pointcloud2(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);
void decode_drake_point_cloud(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);
void decode_pointcloud(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);
void decode_planar_lidar(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);
void decode_mbot_lidar(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);
void decode_scan_sector(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded);

}  // namespace scanlock
