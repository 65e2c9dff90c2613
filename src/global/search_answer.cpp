// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/search_answer.hpp"

#include <algorithm>

#include "global/pose_polish.hpp"

namespace scanlock {

SearchAnswer::SearchAnswer(const LevelMatches& matches, Incumbent& best,
                           const std::optional<ExcludedPoses>& excluded, bool pruning)
    : m_(matches), best_(best), excluded_(excluded), pruning_(pruning) {
  if (!pruning_) return;
  kept_.assign(m_.size(), 0);
  keep(inliers(m_, best_.pose));
}

int SearchAnswer::wanted() const {
  return std::max(1, best_.consensus + (pruning_ ? 0 : 1));
}

bool SearchAnswer::offer(const LevelPose& pose, int count, const std::vector<std::uint32_t>& held) {
  if (excluded_ && excluded_->holds(pose)) return false;
  const int before = best_.consensus;
  if (count > best_.consensus) best_ = {pose, count};
  Incumbent climbed = best_;
  climb(m_, held, climbed);
  if (climbed.consensus > before) polish(m_, climbed);
  if (climbed.consensus > best_.consensus && !(excluded_ && excluded_->holds(climbed.pose))) best_ = climbed;
  if (best_.consensus == before) return false;
  if (pruning_) keep(inliers(m_, best_.pose));
  return true;
}

void SearchAnswer::keep(const std::vector<std::uint32_t>& matches) {
  for (const std::uint32_t i : matches) kept_[i] = 1;
}

bool SearchAnswer::all_kept(const std::vector<std::uint32_t>& matches) const {
  return pruning_ &&
         std::all_of(matches.begin(), matches.end(), [&](std::uint32_t i) { return kept_[i] != 0; });
}

std::vector<std::uint32_t> SearchAnswer::kept() const {
  std::vector<std::uint32_t> list;
  for (std::uint32_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i]) list.push_back(i);
  }
  return list;
}

}  // namespace scanlock
