// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/sector_voting.hpp"

#include <algorithm>
#include <cmath>

namespace scanlock {

SectorVoting::SectorVoting(const LevelMatches& m) : m_(m) {
  double reach = 0;
  narrow_.reserve(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    reach = std::max(reach, std::sqrt(m.px[i] * m.px[i] + m.py[i] * m.py[i]) +
                                std::sqrt(m.qx[i] * m.qx[i] + m.qy[i] * m.qy[i]) + m.threshold[i]);
    narrow_.push_back({static_cast<float>(m.px[i]), static_cast<float>(m.py[i]), static_cast<float>(m.qx[i]),
                       static_cast<float>(m.qy[i])});
  }
  // Each of some ten float operations errs by at most 6e-8 of what it adds up.
  margin_ = static_cast<float>(2e-6 * reach);
  offset_ = static_cast<float>(1.01 * reach) + 4 * margin_;
  constexpr double kFinest = 1 << 20;  // cells across, that a float still tells apart
  smallest_cell_ = std::max(4 * m.largest_threshold, 2 * static_cast<double>(offset_) / kFinest);
}

void SectorVoting::resize(std::size_t n) {
  matches_.resize(n);
  for (std::vector<float>* column : {&px_, &py_, &qx_, &qy_, &reach_}) column->resize(n);
}

/// Loads it in place k if the slab can hold it; returns the next place.
std::size_t SectorVoting::load_one(std::size_t k, std::uint32_t i, double z, double half_z) {
  const double limit = bounding_limit(m_, i), gap = std::max(0.0, std::abs(m_.dz[i] - z) - half_z);
  const double square = limit * limit - gap * gap;
  matches_[k] = i;
  px_[k] = narrow_[i].px;
  py_[k] = narrow_[i].py;
  qx_[k] = narrow_[i].qx;
  qy_[k] = narrow_[i].qy;
  reach_[k] = static_cast<float>(std::sqrt(std::max(0.0, square))) + margin_;
  return k + (square >= 0);
}

std::size_t SectorVoting::load_slab(double z, double half_z) {
  const double outside = m_.largest_threshold * (1 + kRelativeTolerance) + m_.rounding;
  const auto [first, last] = height_range(m_, z - half_z - outside, z + half_z + outside);
  resize(last - first);
  std::size_t n = 0;
  for (std::size_t i = first; i < last; ++i) n = load_one(n, static_cast<std::uint32_t>(i), z, half_z);
  resize(n);
  return n;
}

std::size_t SectorVoting::load(const std::vector<std::uint32_t>& matches, double z, double half_z) {
  resize(matches.size());
  std::size_t n = 0;
  for (const std::uint32_t i : matches) n = load_one(n, i, z, half_z);
  resize(n);
  return n;
}

/// The rectangle about q - R p over the sector, widened by the threshold, in cells; see BoxFilter.
void SectorVoting::find_spans(const Sector& sector) {
  const std::size_t n = matches_.size();
  for (std::vector<std::int32_t>* span : {&i0_, &i1_, &j0_, &j1_}) span->resize(n);
  const float c = static_cast<float>(std::cos(sector.theta)), s = static_cast<float>(std::sin(sector.theta));
  const float across = static_cast<float>(std::sin(sector.half_theta));
  const float along = static_cast<float>(0.5 * (1 - std::cos(sector.half_theta))), middle = 1 - along;
  const float scale = static_cast<float>(1 / sector.cell), offset = offset_;
  const float *px = px_.data(), *py = py_.data(), *qx = qx_.data(), *qy = qy_.data(), *reach = reach_.data();
  std::int32_t *i0 = i0_.data(), *i1 = i1_.data(), *j0 = j0_.data(), *j1 = j1_.data();
  for (std::size_t k = 0; k < n; ++k) {
    const float rx = c * px[k] - s * py[k], ry = s * px[k] + c * py[k];
    const float half_x = std::abs(ry) * across + std::abs(rx) * along + reach[k];
    const float half_y = std::abs(rx) * across + std::abs(ry) * along + reach[k];
    const float x = qx[k] - middle * rx + offset, y = qy[k] - middle * ry + offset;
    i0[k] = static_cast<std::int32_t>((x - half_x) * scale);  // positive: truncation rounds down
    i1[k] = static_cast<std::int32_t>((x + half_x) * scale);
    j0[k] = static_cast<std::int32_t>((y - half_y) * scale);
    j1[k] = static_cast<std::int32_t>((y + half_y) * scale);
  }
}

int SectorVoting::vote(const Sector& sector) {
  find_spans(sector);
  table_.fill(0);
  std::uint32_t most = 0;
  const std::size_t n = matches_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t i0 = i0_[k], j0 = j0_[k], i1 = i1_[k], j1 = j1_[k];
    if (i1 - i0 <= 1 && j1 - j0 <= 1) {  // nearly all; a loop would be mispredicted at every end
      const auto right = static_cast<std::uint32_t>(i1 - i0), up = static_cast<std::uint32_t>(j1 - j0);
      const std::uint32_t a = table_[slot(i0, j0)] += 1, b = table_[slot(i0 + 1, j0)] += right,
                          c = table_[slot(i0, j0 + 1)] += up, d = table_[slot(i0 + 1, j0 + 1)] += right & up;
      most = std::max({most, a, b, c, d});
      continue;
    }
    const std::int32_t last_i = std::min(i1, i0 + kSide - 1), last_j = std::min(j1, j0 + kSide - 1);
    for (std::int32_t j = j0; j <= last_j; ++j) {
      for (std::int32_t i = i0; i <= last_i; ++i) most = std::max(most, ++table_[slot(i, j)]);
    }
  }
  return static_cast<int>(most);
}

void SectorVoting::open_matches(int at_least, std::vector<std::uint32_t>& matches) const {
  matches.clear();
  const auto least = static_cast<std::uint32_t>(at_least);
  const auto is_open = [&](std::size_t k) {
    if (i1_[k] - i0_[k] <= 1 && j1_[k] - j0_[k] <= 1) {
      const bool a = table_[slot(i0_[k], j0_[k])] >= least, b = table_[slot(i1_[k], j0_[k])] >= least,
                 c = table_[slot(i0_[k], j1_[k])] >= least, d = table_[slot(i1_[k], j1_[k])] >= least;
      return static_cast<bool>(a | b | c | d);
    }
    const std::int32_t i1 = std::min(i1_[k], i0_[k] + kSide - 1), j1 = std::min(j1_[k], j0_[k] + kSide - 1);
    for (std::int32_t j = j0_[k]; j <= j1; ++j) {
      for (std::int32_t i = i0_[k]; i <= i1; ++i) {
        if (table_[slot(i, j)] >= least) return true;
      }
    }
    return false;
  };
  matches.resize(matches_.size());
  std::size_t count = 0;
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    matches[count] = matches_[k];
    count += is_open(k);
  }
  matches.resize(count);
}

std::size_t SectorVoting::members(int at_least) const {
  std::size_t sum = 0;
  for (const std::uint32_t count : table_) sum += count >= static_cast<std::uint32_t>(at_least) ? count : 0;
  return sum;
}

bool SectorVoting::gather(const Sector& sector, int at_least, std::vector<VotedCell>& cells) {
  cells.clear();
  entries_.clear();
  wide_.clear();
  const auto least = static_cast<std::uint32_t>(std::max(at_least, 1));
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    if (is_wide(k)) {
      wide_.push_back(matches_[k]);
      continue;
    }
    for (std::int32_t j = j0_[k]; j <= j1_[k]; ++j) {
      for (std::int32_t i = i0_[k]; i <= i1_[k]; ++i) {
        if (table_[slot(i, j)] < least) continue;
        const std::uint64_t cell = static_cast<std::uint64_t>(j) << 32 | static_cast<std::uint32_t>(i);
        entries_.push_back({cell, matches_[k]});
      }
    }
  }
  if (wide_.size() >= least) return false;
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.match < b.match;
  });
  for (std::size_t from = 0, to = 0; from < entries_.size(); from = to) {
    const std::uint64_t cell = entries_[from].cell;
    while (to < entries_.size() && entries_[to].cell == cell) ++to;
    if (to - from + wide_.size() < least) continue;
    std::vector<std::uint32_t> matches;
    for (std::size_t k = from; k < to; ++k) matches.push_back(entries_[k].match);
    matches.insert(matches.end(), wide_.begin(), wide_.end());
    cells.push_back({cell_box(sector, cell), std::move(matches)});
  }
  return true;
}

PoseBox SectorVoting::cell_box(const Sector& sector, std::uint64_t cell) const {
  const auto i = static_cast<double>(cell & 0xffffffffu), j = static_cast<double>(cell >> 32);
  PoseBox box;
  box.centre = {sector.theta, (i + 0.5) * sector.cell - static_cast<double>(offset_),
                (j + 0.5) * sector.cell - static_cast<double>(offset_), sector.z};
  box.half_x = box.half_y = 0.5 * sector.cell + static_cast<double>(margin_);
  box.half_z = sector.half_z;
  box.half_theta = sector.half_theta;
  return box;
}

}  // namespace scanlock
