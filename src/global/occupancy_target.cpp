// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/occupancy_target.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kChanged = 0.1;  // share of surfaces that have moved, or are errors

std::ptrdiff_t at(int x, int y, int columns) {
  return static_cast<std::ptrdiff_t>(y) * columns + x;
}

std::int8_t units(double log_likelihood) {
  return static_cast<std::int8_t>(
      std::lround(std::clamp(log_likelihood / OccupancyTarget::kUnit, -127.0, 127.0)));
}

}  // namespace

std::size_t OccupancyTarget::width_for(int cells) {
  return static_cast<std::size_t>(std::lower_bound(kWidths.begin(), kWidths.end(), cells) - kWidths.begin());
}

OccupancyTarget::OccupancyTarget(const OccupancyGrid& grid, double reach)
    : cell_(grid.cell()),
      reach_(reach),
      border_(static_cast<int>(std::ceil(reach / grid.cell())) + (1 << kTop)),
      low_(grid.low()),
      size_(grid.size()) {
  const int columns = size_.x() + 2 * border_, rows = size_.y() + 2 * border_;
  std::vector<std::uint8_t> states(static_cast<std::size_t>(at(0, rows, columns)), OccupancyGrid::kUnknown),
      near(states.size(), 0);
  for (int y = 0; y < size_.y(); ++y) {
    for (int x = 0; x < size_.x(); ++x) {
      const std::ptrdiff_t i = at(x + border_, y + border_, columns);
      const OccupancyGrid::State state = grid.state(x, y);
      states[static_cast<std::size_t>(i)] = state;
      if (state != OccupancyGrid::kOccupied) continue;
      for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u) near[static_cast<std::size_t>(i + at(u, v, columns))] = 1;
    }
  }
  double occupied = 1, free = 1, near_surface = 1, far_off = 1;  // cells
  for (std::size_t i = 0; i < states.size(); ++i) {
    occupied += states[i] == OccupancyGrid::kOccupied;
    free += states[i] == OccupancyGrid::kFree;
    near_surface += near[i];
    far_off += near[i] == 0 && states[i] == OccupancyGrid::kFree;
  }
  // Log-likelihood ratios between the right place and chance: of surfaces, to within a cell, and of free
  // space.
  const double on = near_surface / (near_surface + far_off), blocked = occupied / (occupied + free);
  const std::int8_t met = units(log((1 - kChanged) / on)), through = units(log(kChanged / (1 - on))),
                    hidden = units(log(kChanged)),
                    clear = units(log((1 - kChanged * blocked) / (1 - blocked)));
  std::vector<std::int8_t> surface(states.size()), free_space(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool is_free = states[i] == OccupancyGrid::kFree;
    surface[i] = near[i] != 0 ? met : is_free ? through : std::int8_t{0};
    free_space[i] = states[i] == OccupancyGrid::kOccupied ? hidden : is_free ? clear : std::int8_t{0};
  }
  highest_ = {std::max<int>(met, 0), std::max<int>(clear, 0)};
  fill(kSurface, std::move(surface), columns, rows);
  fill(kFreeSpace, std::move(free_space), columns, rows);
}

/// `cells`: in, those of the map and its border; becomes the maxima over ever wider squares, which hold 0
/// beyond the end.
void OccupancyTarget::fill(Sample sample, std::vector<std::int8_t> cells, int columns, int rows) {
  constexpr auto kLarger = [](std::int8_t a, std::int8_t b) { return std::max(a, b); };
  constexpr auto kAtLeastNothing = [](std::int8_t a) { return std::max(a, std::int8_t{0}); };
  std::vector<std::int8_t> wider(cells.size());
  int width = 1;
  for (std::size_t k = 0; k < kWidths.size(); ++k) {
    Table& table = tables_[sample][k];
    while (8 << table.shift <= kWidths[k]) ++table.shift;
    const int stride = 1 << table.shift, wanted = kWidths[k] + stride - 1;
    // Squares of the last width, this one and the next ones, cover one that is wider by at most its width.
    if (const std::ptrdiff_t step = wanted - width; step > 0) {
      for (int y = 0; y < rows; ++y) {
        const auto row = cells.cbegin() + at(0, y, columns);
        const auto end =
            std::transform(row, row + columns - step, row + step, wider.begin() + at(0, y, columns), kLarger);
        std::transform(row + columns - step, row + columns, end, kAtLeastNothing);
      }
      const auto down = step * columns;
      const auto end =
          std::transform(wider.cbegin(), wider.cend() - down, wider.cbegin() + down, cells.begin(), kLarger);
      std::transform(wider.cend() - down, wider.cend(), end, kAtLeastNothing);
    }
    width = wanted;
    table.columns = (columns + stride - 1) >> table.shift;
    table.rows = (rows + stride - 1) >> table.shift;
    table.most.reserve(static_cast<std::size_t>(at(0, table.rows, table.columns)));
    for (int y = 0; y < rows; y += stride)
      for (int x = 0; x < columns; x += stride)
        table.most.push_back(cells[static_cast<std::size_t>(at(x, y, columns))]);
  }
}

}  // namespace scanlock
