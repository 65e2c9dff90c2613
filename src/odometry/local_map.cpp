// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_set>
#include <utility>

#include "geometry/moved_cloud.hpp"
#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kFreshShare = 5;     // all points are indexed together once one in this many is new
constexpr std::size_t kLeastFresh = 4000;  // new points: a tree of so few is built in half a millisecond
constexpr double kSurfaceVoxels = 4.0;     // radius of the neighbourhood of a surface, in voxels
constexpr double kOriginReach = 200.0;     // metres: at this distance a float still resolves 15 micrometres

std::uint64_t voxel_key(const Eigen::Vector3f& p, float inverse_voxel) {
  const Eigen::Vector3f v = (p * inverse_voxel).array().floor();
  return morton_key(static_cast<std::int32_t>(v.x()), static_cast<std::int32_t>(v.y()),
                    static_cast<std::int32_t>(v.z()));
}

bool is_given(const Keyframe& keyframe) {
  return keyframe.given.has_value();
}

double share_of_points(std::size_t some, const Keyframe& keyframe) {
  return static_cast<double>(some) / static_cast<double>(std::max<std::size_t>(keyframe.points.size(), 1));
}

bool is_same(const Keyframe& keyframe, std::uint32_t given, const Pose& map_from_body) {
  return keyframe.given == given && keyframe.map_from_body.matrix() == map_from_body.matrix();
}

}  // namespace

LocalMap::LocalMap(const LocalMapLimits& limits) : limits_(limits) {}

void LocalMap::clear() {
  keyframes_.clear();
  cloud_ = {};
  last_trusted_.clear();
  shown_.clear();
  taken_.clear();
  ground_.clear();
  tree_.rebuild(cloud_);
  surfaces_.reset(cloud_, tree_, 1.0f, planar_);
}

double LocalMap::insert(Keyframe keyframe, double voxel) {
  const Eigen::Vector3d here = keyframe.map_from_body.translation();
  keyframe.id = next_id_++;
  keyframes_.push_back(std::move(keyframe));
  const bool rebuild = wants_rebuild(here, voxel);
  if (rebuild) {
    forget(here, limits_);
    const bool moves = (here - origin_).norm() > kOriginReach || keyframes_.size() == 1;
    const bool other_grid = moves || voxel != voxel_;
    // The numbers of points of given keyframes per voxel are valid for one grid only.
    if (other_grid && is_founded()) return load(taken_out(), voxel);
    if (moves) move_origin(here);
    if (other_grid) note_voxels(voxel);
  }
  const std::size_t novel = add_novel_points(keyframes_.back());
  if (rebuild) {
    index_all();
  } else {
    tree_.grow(cloud_);
    surfaces_.grow();
  }
  return share_of_points(novel, keyframes_.back());
}

double LocalMap::load(std::vector<Keyframe> keyframes, double voxel) {
  clear();
  if (keyframes.empty()) return 0;
  const Eigen::Vector3d here = keyframes.back().map_from_body.translation();
  move_origin(here);
  note_voxels(voxel);
  std::stable_partition(keyframes.begin(), keyframes.end(), is_given);
  std::size_t novel = 0;
  for (Keyframe& keyframe : keyframes) {
    keyframe.id = next_id_++;
    keyframes_.push_back(std::move(keyframe));
    novel = add_novel_points(keyframes_.back());
  }
  forget(here, limits_);
  index_all();
  return share_of_points(novel, keyframes_.back());
}

bool LocalMap::has(std::uint32_t given, const Pose& map_from_body) const {
  return std::any_of(keyframes_.begin(), keyframes_.end(),
                     [&](const Keyframe& k) { return is_same(k, given, map_from_body); });
}

void LocalMap::found_on(std::vector<Keyframe> given, double voxel) {
  drop([&](const Keyframe& old) {
    return old.given && std::none_of(given.begin(), given.end(), [&](const Keyframe& k) {
             return is_same(k, *old.given, old.map_from_body);
           });
  });
  const bool anew = keyframes_.empty() || voxel != voxel_;
  for (Keyframe& keyframe : given) {
    if (has(*keyframe.given, keyframe.map_from_body)) continue;
    keyframe.id = next_id_++;
    if (!anew) add_novel_points(keyframe);
    keyframes_.push_front(std::move(keyframe));
  }
  if (anew) {
    load(taken_out(), voxel);
    return;
  }
  forget(keyframes_.back().map_from_body.translation(), limits_);
  index_all();
}

std::vector<Keyframe> LocalMap::taken_out() {
  return {std::make_move_iterator(keyframes_.begin()), std::make_move_iterator(keyframes_.end())};
}

void LocalMap::index_all() {
  tree_.rebuild(cloud_);
  surfaces_.reset(cloud_, tree_, static_cast<float>(kSurfaceVoxels * voxel_), planar_);
}

void LocalMap::set_planar(bool planar) {
  if (planar == planar_) return;
  planar_ = planar;
  surfaces_.reset(cloud_, tree_, static_cast<float>(kSurfaceVoxels * voxel_), planar_);
}

bool LocalMap::wants_rebuild(const Eigen::Vector3d& here, double voxel) const {
  const std::size_t fresh = cloud_.size() - tree_.old_points();
  return keyframes_.size() == 1 || voxel != voxel_ ||
         fresh > std::max(kLeastFresh, tree_.old_points() / kFreshShare) ||
         cloud_.size() + keyframes_.back().points.size() > static_cast<std::size_t>(limits_.max_points) ||
         (here - origin_).norm() > 2.0 * kOriginReach;
}

void LocalMap::forget(const Eigen::Vector3d& here, const LocalMapLimits& limits) {
  const std::uint32_t newest = keyframes_.back().id;
  drop([&](const Keyframe& k) {
    return k.id != newest && (k.map_from_body.translation() - here).norm() > limits.max_distance;
  });
  const auto oldest = [&] { return std::find_if_not(keyframes_.begin(), keyframes_.end(), is_given); };
  auto own = static_cast<std::ptrdiff_t>(keyframes_.size()) -
             std::count_if(keyframes_.begin(), keyframes_.end(), is_given);
  for (; own > std::max(limits.max_keyframes, 1); --own) keyframes_.erase(oldest());

  std::unordered_set<std::uint32_t> kept;
  std::size_t points = keyframes_.back().points.size();
  for (const Keyframe& k : keyframes_) kept.insert(k.id);
  // The cap counts points of the map; the oldest own keyframes are removed.
  for (std::size_t i = 0; i < cloud_.size(); ++i) points += shown_[i] > 0 || kept.count(last_trusted_[i]) > 0;
  // Leaves room for the points that are added before the next rebuild.
  auto most = static_cast<std::size_t>(limits.max_points);
  most -= most / kFreshShare;
  for (; points > most && own > 1; --own) {
    const auto gone = oldest();
    points -= static_cast<std::size_t>(std::count(last_trusted_.begin(), last_trusted_.end(), gone->id));
    kept.erase(gone->id);
    keyframes_.erase(gone);
  }
  forget_points();
}

/// Removes the points in voxels of which no keyframe has a point any more.
void LocalMap::forget_points() {
  std::unordered_set<std::uint32_t> kept;
  for (const Keyframe& k : keyframes_) kept.insert(k.id);
  std::vector<std::uint32_t> stay, last_trusted, shown, now(cloud_.size(), VoxelIndex::kGone);
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    if (shown_[i] == 0 && !kept.count(last_trusted_[i])) continue;
    now[i] = static_cast<std::uint32_t>(stay.size());
    stay.push_back(i);
    last_trusted.push_back(last_trusted_[i]);
    shown.push_back(shown_[i]);
  }
  cloud_ = select(cloud_, stay);
  last_trusted_ = std::move(last_trusted);
  shown_ = std::move(shown);
  taken_.renumber(now);
  note_ground();
}

void LocalMap::move_origin(const Eigen::Vector3d& here) {
  // Whole metres, so that the shift is exact in floats for points near the robot.
  const Eigen::Vector3d origin = here.array().round();
  const Eigen::Vector3f shift = (origin_ - origin).cast<float>();
  origin_ = origin;
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    cloud_.x[i] += shift.x();
    cloud_.y[i] += shift.y();
    cloud_.z[i] += shift.z();
    cloud_.viewpoints[i] += shift;
  }
}

void LocalMap::note_voxels(double voxel) {
  voxel_ = voxel;
  const float inverse_voxel = static_cast<float>(1.0 / voxel);
  taken_.clear();
  for (std::uint32_t i = 0; i < cloud_.size(); ++i)
    taken_.insert(voxel_key(cloud_.point(i), inverse_voxel), i);
  note_ground();
}

void LocalMap::note_ground() {
  const auto inverse_cell = static_cast<float>(1.0 / (kSurfaceVoxels * voxel_));
  ground_.clear();
  for (std::uint32_t i = 0; i < cloud_.size(); ++i)
    ground_.insert(voxel_key(cloud_.point(i), inverse_cell), last_trusted_[i]);
}

template <typename Visit>
void LocalMap::each_point(const Keyframe& keyframe, const Visit& visit) const {
  const float inverse_voxel = static_cast<float>(1.0 / voxel_);
  const Eigen::Matrix3f rotation = keyframe.map_from_body.linear().cast<float>();
  const Eigen::Vector3f translation = (keyframe.map_from_body.translation() - origin_).cast<float>();
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    const Eigen::Vector3f p = rotation * keyframe.points.point(i) + translation;
    visit(i, p, voxel_key(p, inverse_voxel));
  }
}

std::size_t LocalMap::add_novel_points(const Keyframe& keyframe) {
  std::size_t novel = 0;
  const auto inverse_cell = static_cast<float>(1.0 / (kSurfaceVoxels * voxel_));
  const Eigen::Vector3f eye = (keyframe.map_from_body.translation() - origin_).cast<float>();
  each_point(keyframe, [&](std::size_t i, const Eigen::Vector3f& p, std::uint64_t key) {
    if (ground_.insert(voxel_key(p, inverse_cell), keyframe.id) == keyframe.id) ++novel;
    const auto next = static_cast<std::uint32_t>(cloud_.size());
    const std::uint32_t point = taken_.insert(key, next);
    if (point == next) {
      cloud_.push_back(p);
      last_trusted_.push_back(keyframe.id);
      shown_.push_back(0);
      cloud_.viewpoints.push_back(eye);
      cloud_.alone.push_back(keyframe.points.is_alone(i));
    } else if (!keyframe.given) {
      last_trusted_[point] = keyframe.id;
    } else if (shown_[point] == 0) {
      cloud_.x[point] = p.x();
      cloud_.y[point] = p.y();
      cloud_.z[point] = p.z();
      cloud_.viewpoints[point] = eye;
      cloud_.alone[point] = keyframe.points.is_alone(i);
    }
    if (keyframe.given) ++shown_[point];
  });
  return novel;
}

/// Removes the keyframes for which `out` is true. The points of a removed given keyframe stay only in voxels
/// that another given keyframe or one of the robot's own covers.
template <typename Out>
void LocalMap::drop(const Out& out) {
  for (const Keyframe& k : keyframes_) {
    if (!k.given || !out(k)) continue;
    each_point(k, [&](std::size_t, const Eigen::Vector3f&, std::uint64_t key) {
      if (const auto point = taken_.at(key)) --shown_[*point];
    });
  }
  keyframes_.erase(std::remove_if(keyframes_.begin(), keyframes_.end(), out), keyframes_.end());
}

PointCloud LocalMap::around(const Eigen::Vector3d& centre, double radius) const {
  const Eigen::Vector3f here = (centre - origin_).cast<float>();
  const auto radius2 = static_cast<float>(radius * radius);
  PointCloud near;
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const Eigen::Vector3f p = cloud_.point(i) - here;
    if (!(p.head<2>().squaredNorm() < radius2)) continue;
    near.push_back(p);
    near.viewpoints.push_back(cloud_.viewpoints[i] - here);
  }
  return near;
}

PointCloud LocalMap::snapshot() const {
  return moved(cloud_, Pose(Eigen::Translation3d(origin_)));
}

}  // namespace scanlock
