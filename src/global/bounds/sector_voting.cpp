// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/bounds/sector_voting.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {

SectorVoting::SectorVoting(const LevelMatches& m) : m_(m) {
  double reach = 0;
  narrow_.reserve(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    reach = std::max(reach, std::sqrt(m.px[i] * m.px[i] + m.py[i] * m.py[i]) +
                                std::sqrt(m.qx[i] * m.qx[i] + m.qy[i] * m.qy[i]) + m.threshold[i]);
    narrow_.push_back({static_cast<float>(m.px[i]), static_cast<float>(m.py[i]), static_cast<float>(m.qx[i]),
                       static_cast<float>(m.qy[i]), m.dz[i], bounding_limit(m, i)});
  }
  // Each of about ten float operations has an error of at most 6e-8 of its operands.
  margin_ = static_cast<float>(2e-6 * reach);
  offset_ = static_cast<float>(1.01 * reach) + 4 * margin_;
  constexpr double kFinest = 1 << 20;  // largest number of cells along an axis that floats can distinguish
  smallest_cell_ = std::max(4 * m.largest_threshold, 2 * static_cast<double>(offset_) / kFinest);
}

void SectorVoting::set_slab(double z, double half_z, std::size_t most) {
  z_ = z;
  half_z_ = half_z;
  resize(most);
  few_ = most <= VoteTable<std::int16_t>::kMost;
  lanes_ = few_ ? VoteTable<std::int16_t>::kLanes : VoteTable<std::int32_t>::kLanes;
  for (int first = 0; first < lanes_; ++first) {
    std::uint64_t vote = 0;
    for (int last = first; last < lanes_; ++last) {
      vote |= few_ ? VoteTable<std::int16_t>::vote_in(last) : VoteTable<std::int32_t>::vote_in(last);
      lane_votes_[static_cast<std::size_t>(first * kMostLanes + last)] = vote;
    }
  }
}

void SectorVoting::resize(std::size_t n) {
  matches_.resize(n);
  votes_.resize(n);
  blocks_.resize(n);
  for (std::vector<float>* column : {&px_, &py_, &qx_, &qy_, &reach_}) column->resize(n);
  for (std::vector<std::int32_t>* span : {&i0_, &i1_, &j0_, &j1_}) span->resize(n);
}

/// Loads match i in place k if a pose of the slab can hold it; returns the next free place.
std::size_t SectorVoting::load_one(std::size_t k, std::uint32_t i) {
  const Narrow& m = narrow_[i];
  const double height = m.dz - z_, gap = std::max(0.0, std::abs(height) - half_z_);
  const double square = m.limit * m.limit - gap * gap;
  matches_[k] = i;
  px_[k] = m.px;
  py_[k] = m.py;
  qx_[k] = m.qx;
  qy_[k] = m.qy;
  reach_[k] = std::sqrt(static_cast<float>(std::max(0.0, square))) + margin_;
  const double limit = m.limit * (1 + 1e-9) + m_.rounding, lanes = 0.5 * lanes_ / half_z_;
  const double first = (height - limit + half_z_) * lanes, last = (height + limit + half_z_) * lanes;
  const int top = lanes_ - 1;
  votes_[k] = lane_votes_[static_cast<std::size_t>(std::clamp(static_cast<int>(first), 0, top) * kMostLanes +
                                                   std::clamp(static_cast<int>(last), 0, top))];
  return k + (square >= 0);
}

std::size_t SectorVoting::load_slab(double z, double half_z) {
  const double outside = m_.largest_threshold * (1 + kRelativeTolerance) + m_.rounding;
  const auto [from, to] = height_range(m_, z - half_z - outside, z + half_z + outside);
  set_slab(z, half_z, to - from);
  std::size_t n = 0;
  for (std::size_t i = from; i < to; ++i) n = load_one(n, static_cast<std::uint32_t>(i));
  resize(n);
  return n;
}

std::size_t SectorVoting::load(const std::vector<std::uint32_t>& matches, double z, double half_z) {
  set_slab(z, half_z, matches.size());
  std::size_t n = 0;
  for (const std::uint32_t i : matches) n = load_one(n, i);
  resize(n);
  return n;
}

/// The cells of each match: the bounding rectangle of q - R p over the sector, widened by the threshold; see
/// BoxFilter.
void SectorVoting::find_cells(const Sector& sector) {
  using Table = VoteTable<std::int16_t>;
  const float c = static_cast<float>(cos(sector.theta)), s = static_cast<float>(sin(sector.theta));
  const float across = static_cast<float>(sin(sector.half_theta));
  const float along = static_cast<float>(0.5 * (1 - cos(sector.half_theta))), middle = 1 - along;
  const float scale = static_cast<float>(1 / sector.cell), offset = offset_;
  const float *px = px_.data(), *py = py_.data(), *qx = qx_.data(), *qy = qy_.data(), *reach = reach_.data();
  std::int32_t *i0 = i0_.data(), *i1 = i1_.data(), *j0 = j0_.data(), *j1 = j1_.data();
  std::uint32_t* block = blocks_.data();
  for (std::size_t k = 0, n = matches_.size(); k < n; ++k) {
    const float rx = c * px[k] - s * py[k], ry = s * px[k] + c * py[k];
    const float half_x = std::abs(ry) * across + std::abs(rx) * along + reach[k];
    const float half_y = std::abs(rx) * across + std::abs(ry) * along + reach[k];
    const float x = qx[k] - middle * rx + offset, y = qy[k] - middle * ry + offset;
    const auto left = static_cast<std::int32_t>((x - half_x) * scale);  // positive: truncation rounds down
    const auto right = static_cast<std::int32_t>((x + half_x) * scale);
    const auto low = static_cast<std::int32_t>((y - half_y) * scale);
    const auto high = static_cast<std::int32_t>((y + half_y) * scale);
    i0[k] = left;
    i1[k] = right;
    j0[k] = low;
    j1[k] = high;
    const std::uint32_t place = Table::block(left, low) + (right > left ? Table::kTwoAlongI : 0) +
                                (high > low ? Table::kTwoAlongJ : 0);
    block[k] = ((right - left) | (high - low)) > 1 ? kNoBlock : place;
  }
}

/// Visits blocks that cover each cell that a match votes for once.
template <typename Visit>
void SectorVoting::for_each_block(std::size_t k, const Visit& visit) const {
  using Table = VoteTable<std::int16_t>;
  const std::int32_t last_i = std::min(i1_[k], i0_[k] + kSide - 1),
                     last_j = std::min(j1_[k], j0_[k] + kSide - 1);
  for (std::int32_t j = j0_[k]; j <= last_j; j += 2) {
    const std::uint32_t two_up = j < last_j ? Table::kTwoAlongJ : 0;
    for (std::int32_t i = i0_[k]; i <= last_i; i += 2)
      visit(Table::block(i, j) + two_up + (i < last_i ? Table::kTwoAlongI : 0));
  }
}

template <typename Lane>
int SectorVoting::vote(VoteTable<Lane>& table) {
  table.clear();
  large_.resize(matches_.size());
  std::size_t large = 0;
  for (std::size_t k = 0; k < matches_.size(); ++k) {  // no branch: it would be mispredicted
    large_[large] = static_cast<std::uint32_t>(k);
    large += blocks_[k] == kNoBlock;
    table.add(blocks_[k], votes_[k]);
  }
  large_.resize(large);
  for (const std::uint32_t k : large_)
    for_each_block(k, [&](std::uint32_t block) { table.add(block, votes_[k]); });
  const auto most = table.count();
  std::copy(most.begin(), most.end(), most_.begin());
  return *std::max_element(most.begin(), most.end());
}

int SectorVoting::vote(const Sector& sector) {
  find_cells(sector);
  return few_ ? vote(table_) : vote(wide_table_);
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
void SectorVoting::open_matches(VoteTable<Lane>& table, int at_least, std::vector<std::uint32_t>& matches) {
  table.mark(at_least);
  for (const std::uint32_t k : large_) {
    std::uint64_t marks = 0;
    for_each_block(k, [&](std::uint32_t block) { marks |= table.marked(block, votes_[k]); });
    blocks_[k] = marks != 0 ? kMarkedBlock : kNoBlock;
  }
  open_.resize(matches_.size());
  std::size_t count = 0;
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    open_[count] = matches_[k];
    count += table.marked(blocks_[k], votes_[k]) != 0;
  }
  matches.assign(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(count));
}

void SectorVoting::open_matches(int at_least, std::vector<std::uint32_t>& matches) {
  few_ ? open_matches(table_, at_least, matches) : open_matches(wide_table_, at_least, matches);
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
    const bool is_large = blocks_[k] >= kNoBlock;
    if (!is_large && table.marked(blocks_[k], votes_[k]) == 0) continue;
    for (std::int32_t j = j0_[k]; j <= j1_[k]; ++j) {
      for (std::int32_t i = i0_[k]; i <= i1_[k]; ++i) {
        if (!table.marked(table.block(i, j), votes_[k])) continue;
        const std::uint64_t cell = static_cast<std::uint64_t>(j) << 32 | static_cast<std::uint32_t>(i);
        entries_.push_back({cell, matches_[k]});
      }
    }
  }
}

bool SectorVoting::gather(const Sector& sector, int at_least, std::vector<VotedCell>& cells) {
  cells.clear();
  const auto least = static_cast<std::size_t>(std::max(at_least, 1));
  few_ ? collect_entries(table_, std::max(at_least, 1)) : collect_entries(wide_table_, std::max(at_least, 1));
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
