// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/sector_assembler.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "messages/encode_scan.hpp"
#include "sample_scan.hpp"

using namespace scanlock;

namespace {

std::vector<DecodedScan> sectors_of(const Scan& scan, std::int32_t seq, std::size_t max_bytes = 2000) {
  std::vector<DecodedScan> sectors;
  for (const Bytes& bytes : encode_sectors(scan, {seq, "lidar"}, max_bytes)) {
    CHECK(bytes.size() <= max_bytes);
    sectors.push_back(decode_scan(bytes.data(), bytes.size()));
    REQUIRE(sectors.back().error == "");
  }
  return sectors;
}

Scan scan_at(std::int64_t utime, int count = 1000) {
  Scan scan = sample_scan(count);
  scan.utime = utime;
  return scan;
}

std::vector<DecodedScan> add_all(SectorAssembler& assembler, const std::vector<DecodedScan>& sectors) {
  std::vector<DecodedScan> finished;
  for (const DecodedScan& sector : sectors)
    for (DecodedScan& scan : assembler.add(sector)) finished.push_back(std::move(scan));
  return finished;
}

}  // namespace

TEST_CASE("a real scan takes sectors under 60 KB and comes back to half a count") {
  const Scan scan = scan_at(1000000, 120000);
  const auto sectors = sectors_of(scan, 1, 60000);
  CHECK(sectors.size() == 19);
  SectorAssembler assembler;
  const auto finished = add_all(assembler, sectors);
  REQUIRE(finished.size() == 1);
  const PointCloud& points = finished[0].scan.points;
  CHECK(finished[0].sectors_missing == 0);
  CHECK(finished[0].scan.utime == scan.utime);
  REQUIRE(points.size() == scan.points.size());
  REQUIRE(points.has_times());
  REQUIRE(points.has_intensity());
  float worst_metres = 0, worst_seconds = 0, worst_intensity = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {  // the sample is ordered by time already
    worst_metres = std::max(worst_metres, (points.point(i) - scan.points.point(i)).cwiseAbs().maxCoeff());
    worst_seconds = std::max(worst_seconds, std::abs(points.time[i] - scan.points.time[i]));
    worst_intensity = std::max(worst_intensity, std::abs(points.intensity[i] - scan.points.intensity[i]));
  }
  CHECK(worst_metres <= 0.5f * 8.0f / 32767.0f * 1.01f);
  CHECK(worst_seconds < 1e-6f);
  CHECK(worst_intensity <= 0.51f);
}

TEST_CASE("sectors in any order give the same scan") {
  auto sectors = sectors_of(scan_at(1000000), 1);
  REQUIRE(sectors.size() > 3);
  SectorAssembler forward, backward;
  const auto one = add_all(forward, sectors);
  std::reverse(sectors.begin(), sectors.end());
  const auto two = add_all(backward, sectors);
  REQUIRE(one.size() == 1);
  REQUIRE(two.size() == 1);
  CHECK(one[0].scan.points.x == two[0].scan.points.x);
  CHECK(one[0].scan.points.time == two[0].scan.points.time);
}

TEST_CASE("a lost sector costs a wedge and not the scan") {
  auto first = sectors_of(scan_at(1000000), 1);
  const std::size_t lost = first[2].scan.points.size();
  first.erase(first.begin() + 2);
  SectorAssembler assembler;
  CHECK(add_all(assembler, first).empty());
  const auto finished = add_all(assembler, sectors_of(scan_at(1100000), 2));
  REQUIRE(finished.size() == 2);
  CHECK(finished[0].scan.utime == 1000000);
  CHECK(finished[0].sectors_missing == 1);
  CHECK(finished[0].scan.points.size() == 1000 - lost);
  CHECK(finished[1].scan.utime == 1100000);
  CHECK(finished[1].sectors_missing == 0);
  CHECK_FALSE(assembler.flush().has_value());
}

TEST_CASE("flush returns the incomplete scan at the end of a log") {
  auto sectors = sectors_of(scan_at(1000000), 1);
  sectors.pop_back();
  SectorAssembler assembler;
  CHECK_FALSE(assembler.flush().has_value());
  CHECK(add_all(assembler, sectors).empty());
  const auto scan = assembler.flush();
  REQUIRE(scan.has_value());
  CHECK(scan->sectors_missing == 1);
}

TEST_CASE("doubled, late and contradicting sectors are thrown away and counted") {
  const auto first = sectors_of(scan_at(1000000), 1), second = sectors_of(scan_at(1100000), 2);
  SectorAssembler assembler;
  assembler.add(first[0]);
  assembler.add(first[0]);
  CHECK(assembler.discarded_sectors() == 1);
  DecodedScan contradicting = first[1];
  contradicting.sector_count += 1;
  assembler.add(contradicting);
  CHECK(assembler.discarded_sectors() == 2);
  CHECK(assembler.add(second[0]).size() == 1);  // the first scan is returned with one sector
  CHECK(assembler.add(first[1]).empty());
  CHECK(assembler.discarded_sectors() == 3);
  CHECK(add_all(assembler, {second.begin() + 1, second.end()}).size() == 1);
  CHECK(add_all(assembler, second).empty());  // sectors of a scan that was already returned
  CHECK(assembler.discarded_sectors() == 3 + static_cast<std::int64_t>(second.size()));
}

TEST_CASE("a sender that restarts at an earlier time is followed") {
  SectorAssembler assembler;
  CHECK(add_all(assembler, sectors_of(scan_at(100000000), 50)).size() == 1);
  CHECK(add_all(assembler, sectors_of(scan_at(5000000), 1)).size() == 1);
}

TEST_CASE("memory is bounded by the limit on points") {
  const auto sectors = sectors_of(scan_at(1000000), 1);
  SectorAssembler assembler(500);
  add_all(assembler, sectors);
  CHECK(assembler.discarded_sectors() > 0);
  const auto scan = assembler.flush();
  REQUIRE(scan.has_value());
  CHECK(scan->scan.points.size() <= 500);
  CHECK(scan->sectors_missing > 0);
}

TEST_CASE("other types and faults pass through") {
  SectorAssembler assembler;
  const Bytes bytes = encode_pointcloud2(scan_at(1000000));
  const auto whole = assembler.add(decode_scan(bytes.data(), bytes.size()));
  REQUIRE(whole.size() == 1);
  CHECK(whole[0].scan.points.size() == 1000);
  const auto fault = assembler.add(decode_scan(bytes.data(), 50));
  REQUIRE(fault.size() == 1);
  CHECK(fault[0].fault == DecodeFault::kTruncated);
}

TEST_CASE("a scan without points or times, and points that cannot be sent") {
  SectorAssembler assembler;
  CHECK(add_all(assembler, sectors_of(Scan{}, 0)).size() == 1);
  Scan scan = scan_at(1000000, 10);
  scan.points.time.clear();
  scan.points.intensity.clear();
  scan.points.x[3] = 1e9f;
  scan.points.y[4] = std::nanf("");
  const auto finished = add_all(assembler, sectors_of(scan, 1));
  REQUIRE(finished.size() == 1);
  CHECK(finished[0].scan.points.size() == 8);
  CHECK_FALSE(finished[0].scan.points.has_times());
}
