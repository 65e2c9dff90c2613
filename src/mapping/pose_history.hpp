// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

/// To what a pose was tied when it was told, so that it can follow the map to where later loop closures put
/// it. Poses are tied to the newest keyframe; one stamp is kept a keyframe and a correction, not one a pose.
class PoseHistory {
 public:
  /// The stamp of poses that are told now, in a map where the newest keyframe is there.
  std::uint32_t stamp(std::uint32_t keyframe, const Pose& map_from_keyframe);
  /// The stamp of poses that are told of a robot which does not know where it is, and goes on from
  /// `keyframe`. Each call begins another one.
  std::uint32_t open(std::uint32_t keyframe, const Pose& map_from_keyframe);
  /// Poses of such a stamp are off: `correction` * told is where they are, in a map where a keyframe, which
  /// they follow from now on, is there.
  void close(std::uint32_t stamp, const Pose& correction, std::uint32_t keyframe,
             const Pose& map_from_keyframe);
  /// A keyframe goes: what is tied to it is tied to the one that was `kept` from now on.
  void replace(std::uint32_t gone, std::uint32_t kept, const Pose& kept_from_gone);
  /// A keyframe goes: what is tied to it stays there.
  void remove(std::uint32_t keyframe, const Pose& map_from_keyframe);

  /// What leads from a pose as it was told to the pose in the map as it is now: correction * told. The
  /// identity, exactly, where its keyframe has not moved. `map_from_keyframe`: where a keyframe is, by its
  /// id.
  Pose correction(std::uint32_t stamp, const std::function<Pose(std::uint32_t)>& map_from_keyframe) const;

 private:
  /// A keyframe as it was before it was replaced or removed.
  struct Anchor {
    enum class Kind : std::int8_t { kKeyframe, kTied, kFixed } kind = Kind::kKeyframe;
    std::uint32_t to = 0;               ///< the keyframe, or the anchor that it is tied to
    Pose from_here = Pose::Identity();  ///< to that anchor; of a fixed one to the map
  };
  struct Stamp {
    std::uint32_t anchor = 0;
    Pose map_from_keyframe = Pose::Identity();
  };
  std::uint32_t anchor_of(std::uint32_t keyframe);

  std::vector<Anchor> anchors_;
  std::map<std::uint32_t, std::uint32_t> current_;  ///< anchor of a keyframe
  std::vector<Stamp> stamps_;
};

}  // namespace scanlock
