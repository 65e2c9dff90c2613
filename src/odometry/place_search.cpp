// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/place_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr int kFirstScans = 2;        // of the first one the motion is hearsay
constexpr int kLongestPause = 600;    // scans between two requests,
constexpr int kRarer = 20;            // and how soon they get rare where they bring nothing
constexpr int kSecondLook = 1;        // scans before one that follows a find, and another one
constexpr int kLooksAScan = 24;       // for so many attempts: what is found again and again convinces nobody
constexpr double kSourceReach = 5.6;  // of the scene's size, radius of what is looked for
constexpr double kVoxel = 0.0675;     // of the scene's size
// What looks alike on one scale seldom does so on another.
constexpr double kStep = 1.35;                  // from one scale to the next
constexpr std::array<int, 2> kScales = {0, 1};  // steps
// Where the body stood in many ways it stands in others, too. A search that allows for them takes several
// times as long.
constexpr std::size_t kManyStands = 4;
constexpr double kTilt = 0.01, kRoughTilt = 0.025;  // radians
constexpr double kOffset = 20.0;  // metres: how far from the anchor, or from the middle of a narrow part

/// So many steps from a size, metres; of sizes that are about the same it is the same, so that parts of the
/// map are described once.
double scale(double size, int steps) {
  const double step = log(kStep);
  return exp(step * (std::round(log(size) / step) + steps));
}

}  // namespace

void PlaceSearch::begin(const std::optional<Eigen::Vector3d>& anchor) {
  anchor_ = anchor;
  others_.clear();
  attempts_ = turn_ = 0;
  careful_ = false;
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
  const double widest = kSourceReach * scale(seen.scene, kScales.back());  // source, on any scale
  request.utime = utime;
  request.up = up.value_or(Eigen::Vector3d::UnitZ());
  request.body_up = seen.map_from_body.linear().col(2);
  if (others_.empty() || turn_ % round_ == 0) {
    const Eigen::Matrix3f level = level_rotation(request.body_up).cast<float>();
    const double reach = wide_ ? (kWidestPart - 1) * widest : kOffset;
    others_ =
        other_centres(archive, PlaceSignature(seen.map.around(here, PlaceSignature::kReach), level), reach);
  }
  const auto others = static_cast<int>(others_.size());
  round_ = anchor_ ? 2 * (1 + others) : others;
  const int turn = turn_ % round_;
  const bool at_anchor = anchor_ && (turn < 2 || turn % 2 == 1);
  const int other = anchor_ ? turn / 2 - 1 : turn;
  // The centre is where a sensor was, so that what it saw through is known to be empty.
  request.target_centre = at_anchor ? archive.nearest(*anchor_).map_from_body.translation()
                                    : others_[static_cast<std::size_t>(other)];
  const double scene = scale(seen.scene, kScales[static_cast<std::size_t>(attempts_) % kScales.size()]);
  request.source_radius = kSourceReach * scene;
  request.radius = at_anchor || !wide_ ? request.source_radius + kOffset : kWidestPart * widest;
  request.voxel = kVoxel * scene;
  request.places = archive.keyframes();
  request.source_centre = here;
  request.source = seen.map.around(here, request.source_radius);
  // A measured attitude goes for every place. Every other round does without: what accelerates measures
  // badly.
  if (up && (turn_ / round_) % 2 == 0) request.source_up = seen.up;
  if (!request.source_up)
    request.stands =
        stands_around(request.places, request.target_centre, request.radius - request.source_radius);
  rough_ = request.stands.size() > kManyStands;
  request.tilt = rough_ && careful_ ? kRoughTilt : kTilt;
  elsewhere_ = !at_anchor;
  out_ = true;
  void_ = false;
  scans_asked_ = seen.scans;
  scans_wanted_ = scans_asked_ + std::min(3 + attempts_ + attempts_ * attempts_ / kRarer, kLongestPause);
  return request;
}

/// What was not used is kept for a window of time.
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
  const bool again = rough_ && !careful_ && !found;  // with care
  careful_ = careful_ || again;
  if (!again) ++attempts_;
  if (again || found)
    scans_wanted_ = std::min(scans_wanted_, scans_asked_ + kSecondLook + attempts_ / kLooksAScan);
  if (!again && (!found || (elsewhere_ && little))) ++turn_;
  return true;
}

std::vector<Eigen::Vector3d> PlaceSearch::other_centres(const KeyframeArchive& archive,
                                                        const PlaceSignature& seen, double reach) const {
  struct Part {
    Eigen::Vector3d centre;
    double likeness;
  };
  std::vector<Part> parts;
  // The parts stay where they are while the map does, so that they are described once.
  for (const ArchivedKeyframe& k : archive.keyframes()) {
    const Eigen::Vector3d& place = k.map_from_body.translation();
    if (anchor_ && (place - *anchor_).norm() < 0.7 * kOffset) continue;
    const double likeness = seen.similarity(*k.signature);
    bool covered = false;
    for (Part& part : parts) {
      if ((place - part.centre).norm() >= reach) continue;
      covered = true;
      part.likeness = std::max(part.likeness, likeness);
    }
    if (!covered) parts.push_back({place, likeness});
  }
  const auto away = [&](const Part& part) { return anchor_ ? (part.centre - *anchor_).norm() : 0.0; };
  std::stable_sort(parts.begin(), parts.end(), [&](const Part& a, const Part& b) {
    return a.likeness != b.likeness ? a.likeness > b.likeness : away(a) < away(b);
  });
  std::vector<Eigen::Vector3d> centres;
  for (const Part& part : parts) centres.push_back(part.centre);
  return centres;
}

}  // namespace scanlock
