// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Stored points cannot be read any more. what() names the file and the remedy.
struct PointsUnreadable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Points that are kept outside of memory.
class StoredPoints {
 public:
  StoredPoints() = default;
  virtual ~StoredPoints() = default;
  StoredPoints(const StoredPoints&) = delete;
  StoredPoints& operator=(const StoredPoints&) = delete;

  virtual std::size_t size() const = 0;
  /// x y z, the same at each call. May be called from several threads at once. Throws PointsUnreadable.
  virtual PointCloud read() const = 0;
};

/// The points of a keyframe, in memory or stored. Copies share the points.
class KeyframePoints {
 public:
  KeyframePoints() : KeyframePoints(PointCloud()) {}
  KeyframePoints(PointCloud cloud) : cloud_(std::make_shared<const PointCloud>(std::move(cloud))) {}
  /// `stored`: never null.
  KeyframePoints(std::shared_ptr<const StoredPoints> stored) : stored_(std::move(stored)) {}

  std::size_t size() const { return stored_ ? stored_->size() : cloud_->size(); }
  bool empty() const { return size() == 0; }
  bool are_stored() const { return stored_ != nullptr; }
  /// Never null. Stored points are read at each call, and only the caller holds them. Throws
  /// PointsUnreadable.
  std::shared_ptr<const PointCloud> cloud() const {
    return stored_ ? std::make_shared<const PointCloud>(stored_->read()) : cloud_;
  }

 private:
  std::shared_ptr<const PointCloud> cloud_;     ///< null if the points are stored
  std::shared_ptr<const StoredPoints> stored_;  ///< null if the points are in memory
};

}  // namespace scanlock
