// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

/// The keyframe that each published pose is tied to, so that the pose can be corrected by later loop
/// closures. Poses are tied to the keyframe that is the newest then; memory is one stamp a keyframe and
/// correction, not one a pose.
class PoseHistory {
 public:
  /// The stamp of poses published now. `keyframe`: the newest one, at `map_from_keyframe`.
  std::uint32_t stamp(std::uint32_t keyframe, const Pose& map_from_keyframe);
  /// The stamp of poses of a lost robot, which has gone on from `keyframe`. Each call begins another stamp.
  std::uint32_t open(std::uint32_t keyframe, const Pose& map_from_keyframe);
  /// Corrects poses of such a stamp to `correction` * published, and ties them to `keyframe`, which is now at
  /// `map_from_keyframe`.
  void close(std::uint32_t stamp, const Pose& correction, std::uint32_t keyframe,
             const Pose& map_from_keyframe);
  /// Keyframe `gone` is removed: poses tied to it are tied to `kept` from now on.
  void replace(std::uint32_t gone, std::uint32_t kept, const Pose& kept_from_gone);
  /// A keyframe is removed: poses tied to it stay where they are.
  void remove(std::uint32_t keyframe, const Pose& map_from_keyframe);

  /// The correction of a published pose in the map as it is now: correction * published. Exactly the identity
  /// where its keyframe has not moved. `map_from_keyframe`: the pose of a keyframe, by its id.
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
