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

/// Which lanes of height can hold each match.
void SectorVoting::set_lanes(double z, double half_z) {
  z_ = z;
  half_z_ = half_z;
  lanes_ = few() ? VoteTable<std::int16_t>::kLanes : VoteTable<std::int32_t>::kLanes;
  const double half = half_z / lanes_;
  votes_.assign(matches_.size(), 0);
  for (int lane = 0; lane < lanes_; ++lane) {
    const double centre = z - half_z + (2 * lane + 1) * half;
    const std::uint64_t vote =
        few() ? VoteTable<std::int16_t>::vote_in(lane) : VoteTable<std::int32_t>::vote_in(lane);
    for (std::size_t k = 0; k < matches_.size(); ++k) {
      const std::uint32_t i = matches_[k];
      const double limit = bounding_limit(m_, i) + half * (1 + 1e-9) + m_.rounding;
      votes_[k] |= std::abs(m_.dz[i] - centre) <= limit ? vote : 0;
    }
  }
}

std::size_t SectorVoting::load_slab(double z, double half_z) {
  const double outside = m_.largest_threshold * (1 + kRelativeTolerance) + m_.rounding;
  const auto [first, last] = height_range(m_, z - half_z - outside, z + half_z + outside);
  resize(last - first);
  std::size_t n = 0;
  for (std::size_t i = first; i < last; ++i) n = load_one(n, static_cast<std::uint32_t>(i), z, half_z);
  resize(n);
  set_lanes(z, half_z);
  return n;
}

std::size_t SectorVoting::load(const std::vector<std::uint32_t>& matches, double z, double half_z) {
  resize(matches.size());
  std::size_t n = 0;
  for (const std::uint32_t i : matches) n = load_one(n, i, z, half_z);
  resize(n);
  set_lanes(z, half_z);
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

template <typename Lane>
int SectorVoting::vote(VoteTable<Lane>& table) {
  table.clear();
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    const std::int32_t i0 = i0_[k], j0 = j0_[k], i1 = i1_[k], j1 = j1_[k];
    const std::uint64_t vote = votes_[k];
    if (i1 - i0 <= 1 && j1 - j0 <= 1) {  // most; a loop would be mispredicted at every end
      const std::uint64_t right = i1 > i0 ? vote : 0, up = j1 > j0 ? vote : 0;
      table.add(table.slot(i0, j0), vote);
      table.add(table.slot(i0 + 1, j0), right);
      table.add(table.slot(i0, j0 + 1), up);
      table.add(table.slot(i0 + 1, j0 + 1), right & up);
      continue;
    }
    const std::int32_t last_i = std::min(i1, i0 + kSide - 1), last_j = std::min(j1, j0 + kSide - 1);
    for (std::int32_t j = j0; j <= last_j; ++j) {
      for (std::int32_t i = i0; i <= last_i; ++i) table.add(table.slot(i, j), vote);
    }
  }
  const auto most = table.most();
  std::copy(most.begin(), most.end(), most_.begin());
  return *std::max_element(most.begin(), most.end());
}

int SectorVoting::vote(const Sector& sector) {
  find_spans(sector);
  return few() ? vote(table_) : vote(wide_table_);
}

void SectorVoting::heights(int at_least, double& z, double& half_z) const {
  int first = lanes_, last = -1;
  for (int lane = 0; lane < lanes_; ++lane) {
    if (most_[static_cast<std::size_t>(lane)] < at_least) continue;
    first = std::min(first, lane);
    last = lane;
  }
  z = z_ + half_z_ * (first + last + 1 - lanes_) / lanes_;
  half_z = half_z_ * (last + 1 - first) / lanes_ * (1 + 1e-12) + m_.rounding;
}

template <typename Lane>
void SectorVoting::open_matches(VoteTable<Lane>& table, int at_least,
                                std::vector<std::uint32_t>& matches) const {
  table.mark(at_least);
  const auto is_open = [&](std::size_t k) {
    const std::uint64_t vote = votes_[k];
    if (i1_[k] - i0_[k] <= 1 && j1_[k] - j0_[k] <= 1) {
      return (table.marked(table.slot(i0_[k], j0_[k]), vote) |
              table.marked(table.slot(i1_[k], j0_[k]), vote) |
              table.marked(table.slot(i0_[k], j1_[k]), vote) |
              table.marked(table.slot(i1_[k], j1_[k]), vote)) != 0;
    }
    const std::int32_t i1 = std::min(i1_[k], i0_[k] + kSide - 1), j1 = std::min(j1_[k], j0_[k] + kSide - 1);
    for (std::int32_t j = j0_[k]; j <= j1; ++j) {
      for (std::int32_t i = i0_[k]; i <= i1; ++i) {
        if (table.marked(table.slot(i, j), vote)) return true;
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

void SectorVoting::open_matches(int at_least, std::vector<std::uint32_t>& matches) {
  few() ? open_matches(table_, at_least, matches) : open_matches(wide_table_, at_least, matches);
}

template <typename Lane>
void SectorVoting::collect_entries(VoteTable<Lane>& table, int at_least) {
  entries_.clear();
  wide_.clear();
  table.mark(at_least);
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    if (is_wide(k)) {
      wide_.push_back(matches_[k]);
      continue;
    }
    for (std::int32_t j = j0_[k]; j <= j1_[k]; ++j) {
      for (std::int32_t i = i0_[k]; i <= i1_[k]; ++i) {
        if (!table.marked(table.slot(i, j), votes_[k])) continue;
        const std::uint64_t cell = static_cast<std::uint64_t>(j) << 32 | static_cast<std::uint32_t>(i);
        entries_.push_back({cell, matches_[k]});
      }
    }
  }
}

bool SectorVoting::gather(const Sector& sector, int at_least, std::vector<VotedCell>& cells) {
  cells.clear();
  const auto least = static_cast<std::size_t>(std::max(at_least, 1));
  few() ? collect_entries(table_, std::max(at_least, 1))
        : collect_entries(wide_table_, std::max(at_least, 1));
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
