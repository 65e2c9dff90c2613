// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>
#include <utility>

#include "../trials.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// The origin of the map and the time of the drive; results must not depend on either.
struct Frame {
  Pose there_from_here = Pose::Identity();
  std::int64_t later = 0;  ///< microseconds
  bool usual() const { return later == 0; }
};

inline Frame far_frame() {
  Frame frame;
  frame.there_from_here.linear() = so3_exp(Eigen::Vector3d(0, 0, 0.7));
  frame.there_from_here.translation() << 4000, -3000, 25;  // 5 km
  frame.later = 31536000000000;                            // a year
  return frame;
}

/// With all trials, runs the calling test case twice: in the usual frame, and in a frame that is far off,
/// turned and later. Otherwise the release build runs it in the second frame, and the sanitisers in the
/// first.
inline Frame each_frame() {
  if (!all_trials()) return kSanitised ? Frame() : far_frame();
  Frame frame;
  SUBCASE("in the usual frame") {}
  SUBCASE("5 km off, turned, a year later") {
    frame = far_frame();
  }
  return frame;
}

/// A tracker that works in a frame. Its inputs and outputs are transformed, so that a test uses the usual
/// frame.
class FramedTracker {
 public:
  FramedTracker(const TrackerConfig& config, const Frame& frame) : tracker_(config), frame_(frame) {
    if (!frame.usual()) tracker_.set_pose(frame.there_from_here);
  }

  TrackedScan track(Scan scan, const ScanPrior& prior = {}) {
    scan.utime += frame_.later;
    TrackedScan tracked = tracker_.track(scan, prior);
    tracked.utime -= frame_.later;
    tracked.map_from_body = here(tracked.map_from_body);
    tracked.epoch -= frame_.usual() ? 0 : 1;
    if (tracked.recovery) {
      tracked.recovery->epoch -= frame_.usual() ? 0 : 1;
      tracked.recovery->map_from_body = here(tracked.recovery->map_from_body);
      tracked.recovery->map_from_predicted =
          here(tracked.recovery->map_from_predicted) * frame_.there_from_here;
    }
    return tracked;
  }
  std::optional<RecoveryRequest> take_request() { return tracker_.take_request(); }
  void give(RecoveryAnswer answer) { tracker_.give(std::move(answer)); }
  void reset() { tracker_.reset(); }
  void set_pose(const Pose& map_from_body) { tracker_.set_pose(frame_.there_from_here * map_from_body); }
  SavedMap save() const { return tracker_.save(); }
  void load(SavedMap saved) { tracker_.load(std::move(saved)); }
  PointCloud map() const { return tracker_.map(); }

 private:
  Pose here(const Pose& there) const { return frame_.there_from_here.inverse() * there; }

  Tracker tracker_;
  Frame frame_;
};

}  // namespace scanlock
