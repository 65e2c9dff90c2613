// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

/// The keyframe that each published pose is tied to, so that later loop closures can correct the pose. A pose
/// is tied to the newest keyframe at its time; memory is one stamp per keyframe and correction, not per pose.
class PoseHistory {
 public:
  /// The stamp of poses published now. `keyframe`: the newest one, with pose `map_from_keyframe`.
  std::uint32_t stamp(std::uint32_t keyframe, const Pose& map_from_keyframe);
  /// The stamp of poses of a lost robot, whose last keyframe on the map was `keyframe`. Each call begins
  /// another stamp.
  std::uint32_t open(std::uint32_t keyframe, const Pose& map_from_keyframe);
  /// Corrects the poses of a stamp of open() to `correction` * published, and ties them to `keyframe`, whose
  /// pose is now `map_from_keyframe`.
  void close(std::uint32_t stamp, const Pose& correction, std::uint32_t keyframe,
             const Pose& map_from_keyframe);
  /// Keyframe `gone` is removed: its poses are tied to `kept` from now on.
  void replace(std::uint32_t gone, std::uint32_t kept, const Pose& kept_from_gone);
  /// A keyframe is removed: its poses keep their present correction.
  void remove(std::uint32_t keyframe, const Pose& map_from_keyframe);

  /// The correction of the poses with this stamp in the present map: the corrected pose is correction *
  /// published. Exactly the identity where the keyframe has not moved. `map_from_keyframe`: returns the pose
  /// of a keyframe, by its id.
  Pose correction(std::uint32_t stamp, const std::function<Pose(std::uint32_t)>& map_from_keyframe) const;

 private:
  /// A keyframe, or what has taken its place: another anchor (kTied), or a fixed pose (kFixed) after its
  /// removal.
  struct Anchor {
    enum class Kind : std::int8_t { kKeyframe, kTied, kFixed } kind = Kind::kKeyframe;
    std::uint32_t to = 0;               ///< id of the keyframe, or index of the anchor that it is tied to
    Pose from_here = Pose::Identity();  ///< pose in the frame of that anchor; for kFixed in the map frame
  };
  struct Stamp {
    std::uint32_t anchor = 0;
    Pose map_from_keyframe = Pose::Identity();
  };
  std::uint32_t anchor_of(std::uint32_t keyframe);

  std::vector<Anchor> anchors_;
  std::map<std::uint32_t, std::uint32_t> current_;  ///< index of the anchor, by keyframe
  std::vector<Stamp> stamps_;
};

}  // namespace scanlock
