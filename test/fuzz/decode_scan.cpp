// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/decode_scan.hpp"

#include "fuzz.hpp"
#include "messages/sector_assembler.hpp"

using namespace scanlock;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  DecodedScan decoded = decode_scan(data, size);
  const PointCloud& points = decoded.scan.points;
  fuzz::require((decoded.fault == DecodeFault::kNone) == decoded.error.empty());
  fuzz::require(decoded.fault == DecodeFault::kNone || points.empty());
  fuzz::require(points.y.size() == points.size() && points.z.size() == points.size());
  fuzz::require(points.time.empty() || points.time.size() == points.size());
  fuzz::require(points.intensity.empty() || points.intensity.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) fuzz::require(points.point(i).allFinite());
  SectorAssembler assembler;
  assembler.add(std::move(decoded));
  assembler.flush();
  return 0;
}
