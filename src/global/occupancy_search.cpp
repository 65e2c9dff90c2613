// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/occupancy_search.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

// Cells between samples, of surfaces and of free space: nearer ones share most of their evidence.
constexpr int kSurfaceStep = 3, kFreeStep = 6;
// See log_odds(). A lead counts relative to the perfect log-likelihood ratio and a few nats of chance.
constexpr double kOddsOfNothing = -6.5, kOddsOfShare = 5.0, kOddsOfLead = 42, kChance = 50;

}  // namespace

std::vector<OccupancySample> samples_of(const OccupancyGrid& source) {
  std::vector<OccupancySample> samples;
  const auto add = [&](int x, int y, OccupancyTarget::Sample what) {
    samples.push_back({(source.low() + Eigen::Array2i(x, y)).cast<double>() + 0.5, what});
  };
  const int columns = source.size().x(), rows = source.size().y();
  const auto has_surface = [&](int x, int y) {
    return x < columns && y < rows && source.state(x, y) == OccupancyGrid::kOccupied;
  };
  for (int y = 0; y < rows; y += kSurfaceStep) {
    for (int x = 0; x < columns; x += kSurfaceStep) {
      for (int i = 0; i < kSurfaceStep * kSurfaceStep; ++i) {
        const int u = x + i % kSurfaceStep, v = y + i / kSurfaceStep;
        if (!has_surface(u, v)) continue;
        add(u, v, OccupancyTarget::kSurface);
        break;
      }
    }
  }
  for (int y = 0; y < rows; y += kFreeStep)
    for (int x = 0; x < columns; x += kFreeStep)
      if (source.state(x, y) == OccupancyGrid::kFree) add(x, y, OccupancyTarget::kFreeSpace);
  return samples;
}

namespace {

/// 2^level poses of the lattice along each axis, from the yaw n and the cell (x, y) on.
struct Box {
  int bound = 0, level = 0, n = 0, x = 0, y = 0;
  bool operator<(const Box& other) const {  // of equal bounds the smallest box comes first
    return std::tuple(bound, -level, -n, -y, -x) <
           std::tuple(other.bound, -other.level, -other.n, -other.y, -other.x);
  }
};

class OccupancySearch {
 public:
  OccupancySearch(const OccupancyGrid& source, const OccupancyTarget& target,
                  const OccupancySearchOptions& options);
  OccupancyMatches run();

 private:
  /// The samples of a box of yaws whose squares have one width: places of their squares in a table when the
  /// box is at its first cell.
  struct Group {
    const OccupancyTarget::Table* table;
    std::vector<std::int32_t> places;
    int highest;  // of the table
    int behind;   // the largest sum of all groups behind this one
  };
  using Turned = std::vector<Group>;

  const Turned& turned(int level, int n);
  void push(const Box& box);
  bool is_excluded(const Box& box) const;
  void settle(const Box& box);
  int cut() const;
  double middle(int first, int level) const { return first + 0.5 * ((1 << level) - 1); }

  const OccupancyTarget& target_;
  OccupancySearchOptions options_;
  std::vector<OccupancySample> points_;
  int turns_ = 1;                            // number of yaws
  double step_ = 0;                          // radians between them
  std::vector<std::vector<Turned>> turned_;  // by level and yaw; empty until used
  std::vector<Box> open_;
  OccupancyMatches result_;
};

OccupancySearch::OccupancySearch(const OccupancyGrid& source, const OccupancyTarget& target,
                                 const OccupancySearchOptions& options)
    : target_(target), options_(options) {
  double reach = 1;
  for (const OccupancySample& sample : samples_of(source)) {
    if (sample.p.norm() * target.cell() > target.reach()) continue;
    reach = std::max(reach, sample.p.norm());
    points_.push_back(sample);
    if (sample.what == OccupancyTarget::kSurface) ++result_.surfaces;
  }
  result_.samples = static_cast<int>(points_.size());
  result_.perfect = OccupancyTarget::kUnit *
                    (target.highest(OccupancyTarget::kSurface) * result_.surfaces +
                     target.highest(OccupancyTarget::kFreeSpace) * (result_.samples - result_.surfaces));
  turns_ = static_cast<int>(std::ceil(2 * kPi * reach));
  step_ = 2 * kPi / turns_;
  turned_.resize(OccupancyTarget::kTop + 1);
  for (int level = 0; level <= OccupancyTarget::kTop; ++level)
    turned_[static_cast<std::size_t>(level)].resize(static_cast<std::size_t>((turns_ >> level) + 1));
}

const OccupancySearch::Turned& OccupancySearch::turned(int level, int n) {
  Turned& result = turned_[static_cast<std::size_t>(level)][static_cast<std::size_t>(n >> level)];
  if (!result.empty()) return result;
  const SineCosine turn = sincos(middle(n, level) * step_);
  const double half = 0.5 * ((1 << level) - 1);
  for (const OccupancySample& point : points_) {
    const double off = half * step_ * point.p.norm();  // cells that the sample moves within the box
    const double x = turn.cosine * point.p.x() - turn.sine * point.p.y() + 0.5 - off,
                 y = turn.sine * point.p.x() + turn.cosine * point.p.y() + 0.5 - off;
    const std::size_t width =
        OccupancyTarget::width_for(std::max(1, 1 + static_cast<int>(std::ceil(2 * (half + off)))));
    const OccupancyTarget::Table& table = target_.table(point.what, width);
    auto group =
        std::find_if(result.begin(), result.end(), [&](const Group& g) { return g.table == &table; });
    if (group == result.end())
      group = result.insert(result.end(), {&table, {}, target_.highest(point.what), 0});
    const int column = (static_cast<int>(std::floor(x)) + target_.border()) >> table.shift,
              row = (static_cast<int>(std::floor(y)) + target_.border()) >> table.shift;
    group->places.push_back(row * table.columns + column);
  }
  int behind = 0;
  for (auto group = result.rbegin(); group != result.rend(); ++group) {
    group->behind = behind;
    behind += group->highest * static_cast<int>(group->places.size());
  }
  return result;
}

/// The log-likelihood ratio, kUnit, up to which no pose is asked for.
int OccupancySearch::cut() const {
  double cut = kSomeOverlap * result_.perfect;
  if (!result_.poses.empty())
    cut = std::max(cut, result_.poses.front().log_likelihood -
                            options_.log_odds * (result_.perfect + kChance) / kOddsOfLead);
  return static_cast<int>(cut / OccupancyTarget::kUnit);
}

/// Whether all poses of the box are at a place that was found.
bool OccupancySearch::is_excluded(const Box& box) const {
  const double half = 0.5 * ((1 << box.level) - 1);
  return std::any_of(result_.poses.begin(), result_.poses.end(), [&](const OccupancyMatch& found) {
    const double x = std::abs(middle(box.x, box.level) + 0.5 - found.x / target_.cell()) + half,
                 y = std::abs(middle(box.y, box.level) + 0.5 - found.y / target_.cell()) + half,
                 turn = middle(box.n, box.level) * step_ - found.yaw;
    return std::sqrt(x * x + y * y) * target_.cell() < options_.distance &&
           std::abs(turn - 2 * kPi * std::round(turn / (2 * kPi))) + half * step_ < options_.angle;
  });
}

void OccupancySearch::push(const Box& box) {
  const Eigen::Array2i first = Eigen::Array2i(box.x, box.y) - target_.low();
  if (box.n >= turns_ || (first >= target_.size()).any() || is_excluded(box)) return;
  Box bounded = box;
  ++result_.nodes;
  const int cut = this->cut();
  for (const Group& group : turned(box.level, box.n)) {
    const OccupancyTarget::Table& table = *group.table;
    const std::int8_t* most = table.most.data() +
                              static_cast<std::ptrdiff_t>(first.y() >> table.shift) * table.columns +
                              (first.x() >> table.shift);
    for (const std::int32_t place : group.places) bounded.bound += most[place];
    result_.work += group.places.size();
    if (bounded.bound + group.behind <= cut) return;
  }
  open_.push_back(bounded);
  std::push_heap(open_.begin(), open_.end());
}

void OccupancySearch::settle(const Box& box) {
  OccupancyMatch match;
  match.x = (box.x + 0.5) * target_.cell();
  match.y = (box.y + 0.5) * target_.cell();
  match.yaw = box.n * step_;
  match.log_likelihood = box.bound * OccupancyTarget::kUnit;
  const Eigen::Array2i first = Eigen::Array2i(box.x, box.y) - target_.low();
  const OccupancyTarget::Table& cells = target_.table(OccupancyTarget::kSurface, 0);
  const std::ptrdiff_t here = static_cast<std::ptrdiff_t>(first.y()) * cells.columns + first.x();
  for (const Group& group : turned(0, box.n)) {
    if (group.table != &cells) continue;
    match.surfaces +=
        static_cast<int>(std::count_if(group.places.begin(), group.places.end(), [&](std::int32_t place) {
          return cells.most[static_cast<std::size_t>(place + here)] > 0;
        }));
  }
  result_.poses.push_back(match);
}

OccupancyMatches OccupancySearch::run() {
  const int wide = 1 << OccupancyTarget::kTop;
  for (int n = 0; n < turns_; n += wide)
    for (int y = 0; y < target_.size().y(); y += wide)
      for (int x = 0; x < target_.size().x(); x += wide)
        push({0, OccupancyTarget::kTop, n, target_.low().x() + x, target_.low().y() + y});
  while (!open_.empty() && result_.poses.size() < options_.places && result_.work < options_.max_work) {
    std::pop_heap(open_.begin(), open_.end());
    const Box box = open_.back();
    open_.pop_back();
    if (box.bound <= cut()) {
      open_.clear();
    } else if (is_excluded(box)) {
      continue;
    } else if (box.level == 0) {
      settle(box);
    } else {
      const int half = 1 << (box.level - 1);
      for (int child = 0; child < 8; ++child)
        push({0, box.level - 1, box.n + (child & 1 ? half : 0), box.x + (child & 2 ? half : 0),
              box.y + (child & 4 ? half : 0)});
    }
  }
  result_.finished = result_.work < options_.max_work;
  const auto nats = [](int bound) { return bound * OccupancyTarget::kUnit; };
  const double open = open_.empty() ? nats(cut()) : nats(std::max(cut(), open_.front().bound));
  result_.upper_bound = result_.poses.empty() ? open : result_.poses.front().log_likelihood;
  result_.rival_bound = result_.poses.size() > 1 ? result_.poses[1].log_likelihood : open;
  return result_;
}

}  // namespace

double lead_odds(const OccupancyMatches& matches, double log_likelihood) {
  return kOddsOfLead * (matches.upper_bound - log_likelihood) / (matches.perfect + kChance);
}

double log_odds(const OccupancyMatches& matches) {
  if (matches.poses.empty()) return kOddsOfNothing;
  return kOddsOfNothing + kOddsOfShare * matches.upper_bound / matches.perfect +
         lead_odds(matches, matches.rival_bound);
}

OccupancyMatches search_occupancy(const OccupancyGrid& source, const OccupancyTarget& target,
                                  const OccupancySearchOptions& options) {
  return OccupancySearch(source, target, options).run();
}

}  // namespace scanlock
