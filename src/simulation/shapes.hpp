// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

namespace scanlock {

/// All lengths are in metres, in the world frame (z up).
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  ///< of length 1
};

/// The nearest surface hit so far. Before a cast, `range` is the largest range of interest.
struct Hit {
  double range = 0;
  bool found = false;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double reflectivity = 0;  ///< 0 to 1
};

/// A solid box. A ray that starts inside does not hit it.
struct Box {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d world_from_box = Eigen::Matrix3d::Identity();  ///< a rotation
  Eigen::Vector3d half = Eigen::Vector3d::Ones();                ///< half the edge lengths
  double reflectivity = 0.4;

  /// A box rotated about the vertical only; `bottom` is the centre of its lower face, `size` its edge
  /// lengths.
  static Box upright(const Eigen::Vector3d& bottom, double yaw, const Eigen::Vector3d& size,
                     double reflectivity = 0.4);
};

/// A cylinder without caps: only its lateral surface reflects.
struct Cylinder {
  Eigen::Vector3d base = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of length 1
  double length = 1;
  double radius = 0.1;
  double reflectivity = 0.4;
};

/// An ellipsoid along the world axes: solid, or foliage, into which a ray penetrates for a random free path.
struct Ellipsoid {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d radii = Eigen::Vector3d::Ones();
  double density = 0;  ///< hits per metre inside; 0: solid
  double reflectivity = 0.3;
};

/// Each of these functions replaces `hit` when the ray hits the shape at less than `hit.range`, and otherwise
/// does not change it.
void intersect(const Box& box, const Ray& ray, Hit& hit);
void intersect(const Cylinder& cylinder, const Ray& ray, Hit& hit);
/// `random_bits` determines the free path: equal bits give equal hits.
void intersect(const Ellipsoid& ellipsoid, const Ray& ray, std::uint64_t random_bits, Hit& hit);

using Bounds = Eigen::AlignedBox3d;
Bounds bounds_of(const Box& box);
Bounds bounds_of(const Cylinder& cylinder);
Bounds bounds_of(const Ellipsoid& ellipsoid);

}  // namespace scanlock
