// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "geometry/linear.hpp"
#include "geometry/rigid.hpp"
#include "odometry/constraint.hpp"

namespace scanlock {

/// The same measurement from `to` to `from`.
Constraint reversed(const Constraint& constraint);
/// The relative pose of c in a, from those of b in a and of c in b, with independent errors.
Constraint chained(const Constraint& ab, const Constraint& bc);

/// A pose in the frame of another one, and its covariance: right perturbation, [metres; radians].
struct RelativePose {
  Pose from_to = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();
};

/// The error of a constraint, and its derivatives by right perturbations d: from * exp(d) and to * exp(d).
struct ConstraintError {
  Vector6 error = Vector6::Zero();  ///< log(from_to^-1 from^-1 to)
  Matrix6 by_from = Matrix6::Zero(), by_to = Matrix6::Zero();
};
ConstraintError error_of(const Constraint& constraint, const Pose& from, const Pose& to);

/// Poses in one frame, and measured relative poses (constraints) between them. optimise() minimises the sum
/// of the squared errors of odometry and of Welsch's function of the errors of loop closures, by Gauss-Newton
/// steps that descend. The scale of Welsch's function is halved from three times the median error to
/// kLoopScale, as in section 5 of Zhang et al. The first node (of the smallest id) stays. The result depends
/// neither on threads nor on the order in which nodes are inserted.
class PoseGraph {
 public:
  void add(std::uint32_t node, const Pose& map_from_node) { nodes_[node] = map_from_node; }
  /// Both nodes must be in the graph. A second constraint of the same kind (odometry or loop closure) between
  /// them is combined with the first.
  void connect(Constraint constraint);
  /// The same without the search for an earlier one: only where there is no constraint of that kind between
  /// them.
  void connect_new(const Constraint& constraint);
  /// Removes a node: its constraints are chained through the neighbour with the smallest covariance (trace),
  /// so that a chain loses nothing. Its loop closures that the rest of the graph contradicts (weight up to
  /// 0.1) are dropped.
  void remove(std::uint32_t node);

  /// Removes the node `gone` in favour of another node of the same place; `between` is their relative pose.
  /// Constraints of the removed node become constraints of the other one, unless that one already has a
  /// constraint with the same neighbour: so repeated visits neither let the map drift nor add information
  /// from the same surfaces. Its loop closures that the rest of the graph contradicts (weight up to 0.1) are
  /// dropped.
  void replace(std::uint32_t gone, Constraint between);

  /// The largest translation and rotation of any node by the optimisation.
  struct Change {
    double metres = 0, radians = 0;
  };
  Change optimise();
  /// Takes poses that were optimised in a copy of this graph. Nodes added since then move with the last of
  /// the optimised nodes; poses of nodes removed since then are ignored.
  void move(const std::map<std::uint32_t, Pose>& map_from_node);

  /// A pair of nodes.
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// The relative poses of pairs of nodes, the first to the second, from one factorisation. A variance is
  /// (10 km)^2 where no constraints connect the two nodes. Rounding is least for nodes near the first one.
  std::vector<RelativePose> relative(const std::vector<Pair>& pairs) const;
  /// The covariance of one of these.
  Matrix6 covariance(std::uint32_t from, std::uint32_t to) const {
    return relative({{from, to}}).front().covariance;
  }
  /// Welsch's weight of a constraint at scale kLoopScale (0 to 1); 1 for odometry.
  double weight(const Constraint& constraint) const;

  /// The connected components; that of the first node comes first.
  std::vector<PoseGraph> parts() const;
  bool contains(std::uint32_t node) const { return nodes_.count(node) > 0; }
  const std::map<std::uint32_t, Pose>& nodes() const { return nodes_; }
  const std::vector<Constraint>& constraints() const { return constraints_; }

  /// Scale of Welsch's function, in standard deviations. A loop closure keeps 0.84 of its weight at the
  /// expected error of six degrees of freedom, and 0.6 at the error that one in a hundred exceeds.
  static constexpr double kLoopScale = 4.0;

 private:
  std::map<std::uint32_t, Pose> nodes_;
  std::vector<Constraint> constraints_;
};

}  // namespace scanlock
