// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/keyframe_archive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/elementary.hpp"
#include "geometry/voxel_grid.hpp"
#include "odometry/motion_filter.hpp"

namespace scanlock {
namespace {

constexpr std::int64_t kFresh = 60000000;  // microseconds: the drift within a minute is negligible
constexpr double kNeighbourhood = 20.0;    // metres
constexpr std::size_t kMostPoints = 3000;  // of a keyframe
constexpr double kLeastVariance = 1e-8;    // least variance: (0.1 mm)^2 and (0.1 mrad)^2
constexpr float kBodyUpStep = 0.05F;       // radians, between two attitudes that count as different

template <typename Vector>
bool stands_alike(const std::vector<Vector>& body_ups, const Vector& up) {
  const auto least = cos(static_cast<typename Vector::Scalar>(kBodyUpStep));
  return std::any_of(body_ups.begin(), body_ups.end(),
                     [&](const Vector& other) { return up.dot(other) > least; });
}

/// Assumes that z is up in the map frame.
std::shared_ptr<const PlaceSignature> signature_of(const ArchivedKeyframe& k) {
  return std::make_shared<const PlaceSignature>(*k.points.cloud(), k.map_from_body.linear().cast<float>());
}

bool is_fresh(const ArchivedKeyframe& k, std::int64_t utime) {
  return utime - k.utime < kFresh;
}

}  // namespace

Constraint constraint_to(const ArchivedKeyframe& before, const Pose& map_from_here,
                         const Matrix6& covariance) {
  return {before.id, 0, before.map_from_body.inverse() * map_from_here,
          inverse(Matrix6(covariance + kLeastVariance * Matrix6::Identity()))};
}

SavedMap moved(const SavedMap& map, const Pose& there_from_here) {
  SavedMap result = map;
  result.last_pose = renormalised(there_from_here * map.last_pose);
  result.up = there_from_here.linear() * map.up;
  const Eigen::Matrix3f turn = there_from_here.linear().cast<float>();
  for (ArchivedKeyframe& keyframe : result.keyframes) {
    keyframe.map_from_body = renormalised(there_from_here * keyframe.map_from_body);
    for (Eigen::Vector3f& stand : keyframe.body_ups) stand = turn * stand;
  }
  return result;
}

bool KeyframeArchive::wants(std::int64_t utime, const Eigen::Vector3d& position, double reach) const {
  const double spacing = kPlaceSpacing * reach;
  return std::none_of(keyframes_.rbegin(), keyframes_.rend(), [&](const ArchivedKeyframe& k) {
    return is_fresh(k, utime) && (k.map_from_body.translation() - position).norm() < spacing;
  });
}

bool KeyframeArchive::knows(const Eigen::Vector3d& position) const {
  return std::any_of(keyframes_.begin(), keyframes_.end(), [&](const ArchivedKeyframe& k) {
    return (k.map_from_body.translation() - position).norm() < k.reach;
  });
}

double KeyframeArchive::scene(const Eigen::Vector3d& position) const {
  double sum = 0, weights = 0;
  for (const ArchivedKeyframe& k : keyframes_) {
    const double distance = (k.map_from_body.translation() - position).norm();
    const double square = (distance / kNeighbourhood) * (distance / kNeighbourhood);
    const double weight = 1.0 / (1.0 + square * square);
    sum += weight * k.reach;
    weights += weight;
  }
  return sum / weights;
}

void KeyframeArchive::add(std::int64_t utime, const Pose& map_from_body, double reach,
                          const PointCloud& points, const std::optional<Constraint>& constraint) {
  PointCloud thin;
  thin.x = points.x;
  thin.y = points.y;
  thin.z = points.z;
  for (double voxel = kKeyframeVoxel * std::max(reach, 1.0); thin.size() > kMostPoints;
       voxel *= std::sqrt(2.0))
    thin = select(thin, thin_by_voxel(thin, static_cast<float>(voxel)));
  ArchivedKeyframe keyframe;
  keyframe.utime = utime;
  keyframe.map_from_body = map_from_body;
  keyframe.reach = static_cast<float>(reach);
  keyframe.points = std::move(thin);
  keyframe.constraint = constraint;
  keyframe.signature = signature_of(keyframe);
  append(std::move(keyframe));
  evict();
}

/// The constraint of the keyframe, if any, has to be from an archived keyframe.
void KeyframeArchive::append(ArchivedKeyframe keyframe) {
  keyframe.id = next_id_++;
  if (keyframe.constraint) keyframe.constraint->to = keyframe.id;
  keyframes_.push_back(std::move(keyframe));
}

void KeyframeArchive::replace(std::uint32_t gone, std::uint32_t kept) {
  const auto at = [&](std::uint32_t id) {
    return std::find_if(keyframes_.begin(), keyframes_.end(),
                        [id](const ArchivedKeyframe& k) { return k.id == id; });
  };
  std::vector<Eigen::Vector3f>& body_ups = at(kept)->body_ups;
  for (const Eigen::Vector3f& up : at(gone)->body_ups)
    if (body_ups.size() < kMostBodyUps && !stands_alike(body_ups, up)) body_ups.push_back(up);
  keyframes_.erase(at(gone));
  count_points();
}

void KeyframeArchive::move(const std::map<std::uint32_t, Pose>& map_from_body) {
  for (ArchivedKeyframe& keyframe : keyframes_) {
    const auto moved = map_from_body.find(keyframe.id);
    if (moved == map_from_body.end()) continue;
    const Eigen::Matrix3f turn =
        (moved->second.linear() * keyframe.map_from_body.linear().transpose()).cast<float>();
    for (Eigen::Vector3f& stand : keyframe.body_ups) stand = turn * stand;
    keyframe.map_from_body = moved->second;
  }
}

const ArchivedKeyframe* KeyframeArchive::find(std::uint32_t id) const {
  const auto at = std::lower_bound(keyframes_.begin(), keyframes_.end(), id,
                                   [](const ArchivedKeyframe& k, std::uint32_t i) { return k.id < i; });
  return at != keyframes_.end() && at->id == id ? &*at : nullptr;
}

std::size_t KeyframeArchive::nearest_index(const Eigen::Vector3d& position) const {
  const auto distance = [&](const ArchivedKeyframe& k) {
    return (k.map_from_body.translation() - position).squaredNorm();
  };
  const auto nearest = std::min_element(
      keyframes_.begin(), keyframes_.end(),
      [&](const ArchivedKeyframe& a, const ArchivedKeyframe& b) { return distance(a) < distance(b); });
  return static_cast<std::size_t>(nearest - keyframes_.begin());
}

void KeyframeArchive::note_body_up(const Pose& map_from_body) {
  if (keyframes_.empty()) return;
  std::vector<Eigen::Vector3f>& body_ups = keyframes_[nearest_index(map_from_body.translation())].body_ups;
  const Eigen::Vector3f up = map_from_body.linear().col(2).cast<float>();
  if (body_ups.size() < kMostBodyUps && !stands_alike(body_ups, up)) body_ups.push_back(up);
}

std::string KeyframeArchive::restore(std::vector<ArchivedKeyframe> keyframes, bool fixed) {
  std::string fault;
  keyframes_ = std::move(keyframes);
  restored_ = static_cast<std::uint32_t>(keyframes_.size());
  fixed_ = fixed;
  next_id_ = 1;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    keyframes_[i].id = next_id_++;
    try {
      keyframes_[i].signature = signature_of(keyframes_[i]);
    } catch (const PointsUnreadable& error) {
      fault = error.what();
      keyframes_[i].signature =
          std::make_shared<const PlaceSignature>(PointCloud(), Eigen::Matrix3f::Identity());
    }
    keyframes_[i].constraint.reset();
    if (i == 0) continue;
    const ArchivedKeyframe& before = keyframes_[i - 1];
    keyframes_[i].constraint =
        constraint_to(before, keyframes_[i].map_from_body, kPoseFloor * kPoseFloor * Matrix6::Identity());
    keyframes_[i].constraint->to = keyframes_[i].id;
  }
  evict();
  return fault;
}

double KeyframeArchive::begin_submap(const KeyframeArchive& seen) {
  double last = -std::numeric_limits<double>::infinity(), first = -last;
  for (const ArchivedKeyframe& k : keyframes_) last = std::max(last, k.map_from_body.translation().x());
  for (const ArchivedKeyframe& k : seen.keyframes_)
    first = std::min(first, k.map_from_body.translation().x());
  const double away = seen.empty() ? 0.0 : std::max(0.0, last + kSubmapsApart - first);
  for (ArchivedKeyframe& k : keyframes_) k.map_from_body.translation().x() -= away;
  std::map<std::uint32_t, std::uint32_t> ids;  // in this archive, by id in `seen`
  for (ArchivedKeyframe k : seen.keyframes_) {
    ids.emplace(k.id, next_id_);
    if (const auto from = k.constraint ? ids.find(k.constraint->from) : ids.end(); from != ids.end())
      k.constraint->from = from->second;
    else
      k.constraint.reset();
    append(std::move(k));
  }
  evict();
  return away;
}

KeyframeArchive KeyframeArchive::without(const std::map<std::uint32_t, Pose>& nodes,
                                         bool without_fixed) const {
  KeyframeArchive others(max_points_);
  for (const ArchivedKeyframe& k : keyframes_) {
    if (nodes.count(k.id) == 0 && !(without_fixed && is_fixed(k.id))) others.keyframes_.push_back(k);
  }
  return others;
}

void KeyframeArchive::clear() {
  keyframes_.clear();
  points_ = 0;
  restored_ = 0;
}

/// Position in the list of the first keyframe that was not restored.
std::size_t KeyframeArchive::first_of_own() const {
  const auto own = std::partition_point(keyframes_.begin(), keyframes_.end(),
                                        [&](const ArchivedKeyframe& k) { return k.id <= restored_; });
  return static_cast<std::size_t>(own - keyframes_.begin());
}

void KeyframeArchive::count_points() {
  points_ = 0;
  for (std::size_t i = first_of_own(); i < keyframes_.size(); ++i) points_ += keyframes_[i].points.size();
}

void KeyframeArchive::evict() {
  count_points();
  const std::size_t first = first_of_own();
  std::size_t gone = first;  // end of the evicted range
  while (points_ > max_points_ && gone + 1 < keyframes_.size()) points_ -= keyframes_[gone++].points.size();
  keyframes_.erase(keyframes_.begin() + static_cast<std::ptrdiff_t>(first),
                   keyframes_.begin() + static_cast<std::ptrdiff_t>(gone));
}

std::vector<Eigen::Vector3d> body_ups_around(const std::vector<ArchivedKeyframe>& keyframes,
                                             const Eigen::Vector3d& centre, double radius) {
  std::vector<Eigen::Vector3d> all;
  const auto take = [&](const Eigen::Vector3d& up) {
    if (!stands_alike(all, up)) all.push_back(up);
  };
  for (const ArchivedKeyframe& k : keyframes) {
    if ((k.map_from_body.translation() - centre).norm() > radius) continue;
    take(k.map_from_body.linear().col(2));
    for (const Eigen::Vector3f& up : k.body_ups) take(up.cast<double>().normalized());
  }
  return all;
}

std::vector<const ArchivedKeyframe*> keyframes_seeing(const std::vector<ArchivedKeyframe>& keyframes,
                                                      const Eigen::Vector3d& centre, double radius) {
  std::vector<const ArchivedKeyframe*> result;
  for (const ArchivedKeyframe& k : keyframes) {
    const Eigen::Vector3d offset = k.map_from_body.translation() - centre;
    if (offset.head<2>().norm() <= radius + 4.0 * k.reach) result.push_back(&k);
  }
  return result;
}

PointCloud submap_around(const std::vector<ArchivedKeyframe>& keyframes, const Eigen::Vector3d& centre,
                         double radius, double voxel) {
  ThinnedCloud all(static_cast<float>(voxel));
  const auto radius2 = static_cast<float>(radius * radius);
  for (const ArchivedKeyframe* k : keyframes_seeing(keyframes, centre, radius)) {
    const Eigen::Matrix3f rotation = k->map_from_body.linear().cast<float>();
    const Eigen::Vector3f translation = (k->map_from_body.translation() - centre).cast<float>();
    const std::shared_ptr<const PointCloud> points = k->points.cloud();
    for (std::size_t i = 0; i < points->size(); ++i) {
      const Eigen::Vector3f p = rotation * points->point(i) + translation;
      if (!(p.head<2>().squaredNorm() < radius2)) continue;
      all.points().push_back(p);
      all.points().viewpoints.push_back(translation);
    }
    all.settle();
  }
  return all.take();
}

}  // namespace scanlock
