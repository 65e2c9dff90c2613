// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "global/occupancy_grid.hpp"

namespace scanlock {

/// The likelihoods of the cells of a map, and their maxima over squares of cells, for searches in it.
class OccupancyTarget {
 public:
  /// `reach`: metres, of the sources that will be searched for; farther points are left out.
  OccupancyTarget(const OccupancyGrid& grid, double reach);

  /// What a source shows of a cell.
  enum Sample : std::uint8_t { kSurface, kFreeSpace };
  /// Widths, in cells, of the squares.
  static constexpr std::array kWidths = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128};
  static constexpr double kUnit = 1.0 / 32;  ///< nats

  /// For squares of one width, whose corners are `stride` (a power of two) cells apart: the largest
  /// log-likelihood ratio (kUnit) of a sample anywhere in a square that begins at the corner or less than a
  /// stride behind it.
  struct Table {
    int shift = 0;  ///< stride = 2^shift
    int columns = 0, rows = 0;
    std::vector<std::int8_t> most;
  };
  const Table& table(Sample sample, std::size_t width) const { return tables_[sample][width]; }
  /// The width, as an index of kWidths, of the smallest square of so many cells.
  static std::size_t width_for(int cells);

  int highest(Sample sample) const { return highest_[sample]; }  ///< of all cells, kUnit

  double cell() const { return cell_; }                 ///< metres
  double reach() const { return reach_; }               ///< metres
  const Eigen::Array2i& low() const { return low_; }    ///< first cell of the map, see OccupancyGrid
  const Eigen::Array2i& size() const { return size_; }  ///< cells
  int border() const { return border_; }                ///< cells by which the tables extend beyond the map
  static constexpr int kTop = 6;  ///< the largest boxes of a search have 2^kTop poses along each axis

 private:
  void fill(Sample sample, std::vector<std::int8_t> cells, int columns, int rows);
  double cell_, reach_;
  int border_;
  Eigen::Array2i low_, size_;
  std::array<int, 2> highest_ = {};
  std::array<std::array<Table, kWidths.size()>, 2> tables_;
};

}  // namespace scanlock
