// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/pose_history.hpp"

namespace scanlock {

std::uint32_t PoseHistory::anchor_of(std::uint32_t keyframe) {
  const auto [at, is_new] = current_.emplace(keyframe, static_cast<std::uint32_t>(anchors_.size()));
  if (is_new) anchors_.push_back({Anchor::Kind::kKeyframe, keyframe, Pose::Identity()});
  return at->second;
}

std::uint32_t PoseHistory::stamp(std::uint32_t keyframe, const Pose& map_from_keyframe) {
  const std::uint32_t anchor = anchor_of(keyframe);
  const bool same = !stamps_.empty() && stamps_.back().anchor == anchor &&
                    stamps_.back().map_from_keyframe.matrix() == map_from_keyframe.matrix();
  if (!same) stamps_.push_back({anchor, map_from_keyframe});
  return static_cast<std::uint32_t>(stamps_.size() - 1);
}

std::uint32_t PoseHistory::open(std::uint32_t keyframe, const Pose& map_from_keyframe) {
  stamps_.push_back({anchor_of(keyframe), map_from_keyframe});
  return static_cast<std::uint32_t>(stamps_.size() - 1);
}

void PoseHistory::close(std::uint32_t stamp, const Pose& correction, std::uint32_t keyframe,
                        const Pose& map_from_keyframe) {
  const bool is_right = correction.matrix() == Pose::Identity().matrix();
  const Pose then = is_right ? map_from_keyframe : renormalised(correction.inverse() * map_from_keyframe);
  stamps_[stamp] = {anchor_of(keyframe), then};
}

void PoseHistory::replace(std::uint32_t gone, std::uint32_t kept, const Pose& kept_from_gone) {
  const std::uint32_t before = anchor_of(gone);
  anchors_[before] = {Anchor::Kind::kTied, anchor_of(kept), kept_from_gone};
  current_.erase(gone);
}

void PoseHistory::remove(std::uint32_t keyframe, const Pose& map_from_keyframe) {
  const auto at = current_.find(keyframe);
  if (at == current_.end()) return;
  anchors_[at->second] = {Anchor::Kind::kFixed, 0, map_from_keyframe};
  current_.erase(at);
}

Pose PoseHistory::correction(std::uint32_t stamp,
                             const std::function<Pose(std::uint32_t)>& map_from_keyframe) const {
  const Stamp& then = stamps_[stamp];
  Pose onwards = Pose::Identity();
  const Anchor* anchor = &anchors_[then.anchor];
  for (; anchor->kind == Anchor::Kind::kTied; anchor = &anchors_[anchor->to])
    onwards = anchor->from_here * onwards;
  const Pose now = anchor->kind == Anchor::Kind::kFixed ? anchor->from_here : map_from_keyframe(anchor->to);
  const Pose map_from_here = now * onwards;
  if (map_from_here.matrix() == then.map_from_keyframe.matrix()) return Pose::Identity();
  return renormalised(map_from_here * then.map_from_keyframe.inverse());
}

}  // namespace scanlock
