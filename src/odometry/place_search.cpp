// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr int kFirstScans = 2;        // at the first scan the velocity is not measured yet
constexpr int kLongestPause = 600;    // scans between two requests
constexpr int kRarer = 20;            // attempts^2 / kRarer scans are added to the pause
constexpr int kSecondLook = 1;        // scans between a request that found a place and the next one,
constexpr int kLooksAScan = 24;       // plus one for every 24 attempts: repeated results add little evidence
constexpr double kSourceReach = 5.6;  // of the scene's size: radius of the source
constexpr double kVoxel = 0.0675;     // of the scene's size
constexpr double kStep = 1.35;        // ratio of a scale to the one before
constexpr double kTilt = 0.01;        // radians: error of the recorded attitudes
constexpr double kOffset = 20.0;  // metres: of the robot from the anchor, or from the centre of a narrow part

/// A size, metres, rounded to a power of kStep, so that similar sizes give the same, and so many steps more.
double scale(double size, int steps) {
  const double step = log(kStep);
  return exp(step * (std::round(log(size) / step) + steps));
}

/// Metres: the radius of the source on the widest scale.
double widest_source(double scene) {
  return kSourceReach * scale(scene, kSearchScales - 1);
}

/// The target of a wide part, on one of the scales; without its centre, up and places.
SearchTarget target_of(double scene, int steps) {
  SearchTarget target;
  target.source_radius = kSourceReach * scale(scene, steps);
  target.radius = kWidestPart * widest_source(scene);
  target.voxel = kVoxel * scale(scene, steps);
  return target;
}

/// The mean reach, metres, of the keyframes within `radius` metres of `centre`, weighted by reach squared,
/// because keyframes of shorter reach are more numerous on the same area.
double scene_of_part(const KeyframeArchive& archive, const Eigen::Vector3d& centre, double radius) {
  double sum = 0, weights = 0;
  for (const ArchivedKeyframe& k : archive.keyframes()) {
    if ((k.map_from_body.translation() - centre).norm() > radius) continue;
    const auto reach = static_cast<double>(k.reach);
    sum += reach * reach * reach;
    weights += reach * reach;
  }
  return weights > 0 ? sum / weights : 0;
}

}  // namespace

/// The parts around keyframes, such that each keyframe is in one, except those near the anchor. Those that
/// look most like `seen` come first, where that is given, then those nearest to the anchor.
std::vector<PlaceSearch::Part> PlaceSearch::parts_of(const KeyframeArchive& archive, bool wide,
                                                     const std::optional<Eigen::Vector3d>& anchor,
                                                     const PlaceSignature* seen) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  const auto reach_at = [&](double scene) {
    return wide ? (kWidestPart - 1) * widest_source(scene) : kOffset;
  };
  const double usual_reach = reach_at(scene_of_part(archive, Eigen::Vector3d::Zero(), kAnywhere));
  std::vector<Part> parts;
  // The parts stay the same while the map does, so that each is described only once.
  for (const ArchivedKeyframe& k : archive.keyframes()) {
    const Eigen::Vector3d& place = k.map_from_body.translation();
    if (anchor && (place - *anchor).norm() < 0.7 * kOffset) continue;
    const double likeness = seen ? seen->similarity(*k.signature) : 0;
    bool covered = false;
    for (Part& part : parts) {
      if ((place - part.centre).norm() >= reach_at(part.scene)) continue;
      covered = true;
      part.likeness = std::max(part.likeness, likeness);
    }
    if (!covered) parts.push_back({place, scene_of_part(archive, place, usual_reach), likeness});
  }
  const auto away = [&](const Part& part) { return anchor ? (part.centre - *anchor).norm() : 0.0; };
  std::stable_sort(parts.begin(), parts.end(), [&](const Part& a, const Part& b) {
    return a.likeness != b.likeness ? a.likeness > b.likeness : away(a) < away(b);
  });
  return parts;
}

std::vector<SearchTarget> PlaceSearch::first_targets(const KeyframeArchive& archive) {
  std::vector<SearchTarget> targets;
  const std::vector<Part> parts = parts_of(archive, true, std::nullopt, nullptr);
  if (parts.size() * kSearchScales > PlaceFinder::kTargets) return targets;
  for (int steps = 0; steps < kSearchScales; ++steps) {
    for (const Part& part : parts) {
      targets.push_back(target_of(part.scene, steps));
      targets.back().centre = part.centre;
      targets.back().places = archive.keyframes();
    }
  }
  return targets;
}

void PlaceSearch::begin(const std::optional<Eigen::Vector3d>& anchor) {
  anchor_ = anchor;
  others_.clear();
  attempts_ = turn_ = 0;
  round_ = 2;
}

void PlaceSearch::begin_anew() {
  void_ = true;
  scans_wanted_ = kFirstScans;
}

std::optional<RecoveryRequest> PlaceSearch::next(std::int64_t utime, const Surroundings& seen,
                                                 const KeyframeArchive& archive,
                                                 const std::optional<Eigen::Vector3d>& up) {
  if (!has_credit(utime) || archive.empty() || !is_due(seen.scans) || !(seen.scene > 0)) return std::nullopt;
  RecoveryRequest request;
  request.serial = ++serial_;
  const Eigen::Vector3d here = seen.map_from_body.translation();
  request.utime = utime;
  request.body_up = seen.map_from_body.linear().col(2);
  if (others_.empty() || turn_ % round_ == 0) {
    const Eigen::Matrix3f level = level_rotation(request.body_up).cast<float>();
    const PlaceSignature signature(seen.map.around(here, PlaceSignature::kReach), level);
    others_ = parts_of(archive, wide_, anchor_, &signature);
  }
  const auto others = static_cast<int>(others_.size());
  round_ = anchor_ ? 2 * (1 + others) : others;
  const int turn = turn_ % round_;
  const bool at_anchor = anchor_ && (turn < 2 || turn % 2 == 1);
  const Part* part = at_anchor ? nullptr : &others_[static_cast<std::size_t>(anchor_ ? turn / 2 - 1 : turn)];
  const bool wide = part && wide_;
  SearchTarget& target = request.target;
  target = target_of(wide ? part->scene : seen.scene, attempts_ % kSearchScales);
  if (!wide) target.radius = target.source_radius + kOffset;
  request.finer = attempts_ / kSearchScales % 2 == 1;
  // The centre is a position of the sensor, so that free space is known around it.
  target.centre = part ? part->centre : archive.nearest(*anchor_).map_from_body.translation();
  target.up = up.value_or(Eigen::Vector3d::UnitZ());
  target.places = archive.keyframes();
  request.source_centre = here;
  request.planar = seen.map.planar();
  request.source = seen.map.around(here, target.source_radius);
  // A measured attitude is valid at every place. Every other round does without it: during accelerations the
  // measurement is bad.
  if (up && (turn_ / round_) % 2 == 0) request.source_up = seen.up;
  if (!request.source_up)
    request.body_ups = body_ups_around(target.places, target.centre, target.radius - target.source_radius);
  request.tilt = kTilt;
  elsewhere_ = !at_anchor;
  out_ = true;
  void_ = false;
  scans_asked_ = seen.scans;
  scans_wanted_ = scans_asked_ + std::min(3 + attempts_ + attempts_ * attempts_ / kRarer, kLongestPause);
  return request;
}

/// Adds the credit since the last call, up to that of kWindow seconds. Returns whether any is left.
bool PlaceSearch::has_credit(std::int64_t utime) {
  const double elapsed = 1e-6 * static_cast<double>(utime - credited_utime_);
  credited_utime_ = utime;
  credit_s_ = std::min(credit_s_ + cores_ * std::clamp(elapsed, 0.0, kWindow), cores_ * kWindow);
  return credit_s_ > 0;
}

bool PlaceSearch::take(std::int64_t serial, bool found, bool little, double cost_s) {
  if (!out_ || serial != serial_) return false;
  credit_s_ -= cost_s;
  out_ = false;
  if (void_) return false;
  ++attempts_;
  if (found) scans_wanted_ = std::min(scans_wanted_, scans_asked_ + kSecondLook + attempts_ / kLooksAScan);
  if (!found || (elsewhere_ && little)) ++turn_;
  return true;
}

}  // namespace scanlock
