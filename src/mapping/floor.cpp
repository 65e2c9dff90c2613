// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/floor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace scanlock {
namespace {

constexpr float kHeadroom = 1.5F;  // metres of free height above a floor
constexpr float kTile = 4;         // metres: a multiple of the edges of cells and of blocks of voxels
// Cells: the gap over which cells of one floor connect, so that furniture does not divide it.
constexpr int kAcross = 3;
// Share of the cells of the largest floor: surfaces with fewer cells are roofs or tables.
constexpr double kLeastFloor = 0.05;
constexpr double kLeastCells = 4;  // 1 m2, the size of a robot: isolated points are no floor
// Metres: edge of a tile; deviation from the median height that counts as flat; least and greatest height of
// objects above (or, from ceilings, below) a flat tile.
constexpr float kFlatTile = 2, kFlat = 0.1F, kLowest = 0.2F, kHighest = 2;

/// The number of places that stand out from flat tiles.
std::size_t count_standing(std::vector<FloorPlace> surface) {
  const auto tile = [](const FloorPlace& place) { return cell_of(place.middle(), kFlatTile); };
  std::sort(surface.begin(), surface.end(), [&](const FloorPlace& a, const FloorPlace& b) {
    return std::make_pair(tile(a), a.z) < std::make_pair(tile(b), b.z);
  });
  constexpr float kSide = kFlatTile / kFloorCell;
  std::size_t standing = 0;
  for (std::size_t begin = 0, end = 0; begin < surface.size(); begin = end) {
    while (end < surface.size() && tile(surface[end]) == tile(surface[begin])) ++end;
    const float middle = surface[(begin + end) / 2].z;
    std::size_t flat = 0, above = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const float height = surface[i].z - middle;
      flat += std::abs(height) < kFlat ? 1 : 0;
      above += height > kLowest && height < kHighest ? 1 : 0;
    }
    if (static_cast<float>(flat) >= kSide * kSide / 2) standing += above;
  }
  return standing;
}

/// The heights of the lowest and the highest point of a cell, metres.
struct Column {
  Cell cell;
  float low, high;
};

void compare_sides(std::vector<Column> columns, Floors* floors) {
  std::sort(columns.begin(), columns.end(), [](const Column& a, const Column& b) { return a.cell < b.cell; });
  std::size_t flat = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Column& here = columns[k];
    flat += here.high - here.low < kHeadroom ? 1 : 0;
    if (k + 1 == columns.size()) break;
    const Column& next = columns[k + 1];
    if (next.cell != Cell(here.cell.first, here.cell.second + 1)) continue;
    const bool below = std::abs(next.low - here.low) > kFlat, above = std::abs(next.high - here.high) > kFlat;
    floors->rough_below += below && !above ? 1 : 0;
    floors->rough_above += above && !below ? 1 : 0;
  }
  floors->open = 2 * flat > columns.size();
}

}  // namespace

Cell cell_of(const Eigen::Vector3f& p, float size) {
  return {static_cast<int>(std::floor(p.x() / size)), static_cast<int>(std::floor(p.y() / size))};
}

Floors find_floors(const SolidCloud& solid) {
  // One tile after another: each holds whole columns, and only its points are in memory at once.
  std::vector<std::pair<Cell, SolidCloud::BlockId>> blocks;
  for (const SolidCloud::BlockId block : solid.blocks())
    blocks.emplace_back(cell_of(solid.middle_of(block), kTile), block);
  std::sort(blocks.begin(), blocks.end());
  Floors floors;
  std::vector<FloorPlace> column, roofed, ceiling;  // of `ceiling` z points down
  std::vector<Column> columns;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (const Eigen::Vector3f& p : solid.points_of(blocks[i].second))
      column.push_back({cell_of(p, kFloorCell), p.z()});
    if (i + 1 < blocks.size() && blocks[i + 1].first == blocks[i].first) continue;
    std::sort(column.begin(), column.end());
    for (std::size_t k = 0; k < column.size(); ++k) {
      if (k == 0 || column[k - 1].cell != column[k].cell)
        columns.push_back({column[k].cell, column[k].z, column[k].z});
      columns.back().high = column[k].z;
      const bool last = k + 1 == column.size() || column[k + 1].cell != column[k].cell;
      if (!last && column[k + 1].z - column[k].z < kHeadroom) continue;
      floors.places.push_back(column[k]);
      if (last) continue;
      roofed.push_back(column[k]);
      ceiling.push_back({column[k].cell, -column[k + 1].z});
    }
    floors.standing += count_standing(roofed);
    floors.hanging += count_standing(ceiling);
    column.clear();
    roofed.clear();
    ceiling.clear();
  }
  std::sort(floors.places.begin(), floors.places.end());
  compare_sides(std::move(columns), &floors);
  return floors;
}

std::vector<FloorPlace> wide_floors(const std::vector<FloorPlace>& floor) {
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> part(floor.size(), kNone), border;
  std::vector<std::size_t> sizes;
  for (std::uint32_t seed = 0; seed < part.size(); ++seed) {
    if (part[seed] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(sizes.size());
    sizes.push_back(0);
    part[seed] = number;
    border.push_back(seed);
    while (!border.empty()) {
      const FloorPlace at = floor[border.back()];
      border.pop_back();
      ++sizes.back();
      for (int x = at.cell.first - kAcross; x <= at.cell.first + kAcross; ++x) {
        constexpr float kLowest = -std::numeric_limits<float>::infinity();
        auto next =
            std::lower_bound(floor.begin(), floor.end(), FloorPlace{{x, at.cell.second - kAcross}, kLowest});
        for (; next != floor.end() && next->cell <= Cell(x, at.cell.second + kAcross); ++next) {
          const auto other = static_cast<std::uint32_t>(next - floor.begin());
          if (part[other] != kNone || std::abs(next->z - at.z) > kFloorStep) continue;
          part[other] = number;
          border.push_back(other);
        }
      }
    }
  }
  std::vector<FloorPlace> wide;
  if (sizes.empty()) return wide;
  const double least =
      std::max(kLeastCells, kLeastFloor * static_cast<double>(*std::max_element(sizes.begin(), sizes.end())));
  for (std::size_t i = 0; i < floor.size(); ++i)
    if (static_cast<double>(sizes[part[i]]) >= least) wide.push_back(floor[i]);
  return wide;
}

}  // namespace scanlock
