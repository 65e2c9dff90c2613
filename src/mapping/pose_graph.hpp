// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "geometry/linear.hpp"
#include "geometry/rigid.hpp"
#include "odometry/constraint.hpp"

namespace scanlock {

/// The same measurement seen from its other end.
Constraint reversed(const Constraint& constraint);
/// The relative pose of c in a, from those of b in a and of c in b, whose errors are independent.
Constraint chained(const Constraint& ab, const Constraint& bc);

/// The error of a constraint, and its derivatives by perturbations from exp(d) and to exp(d).
struct ConstraintError {
  Vector6 error = Vector6::Zero();  ///< log(from_to^-1 from^-1 to)
  Matrix6 by_from = Matrix6::Zero(), by_to = Matrix6::Zero();
};
ConstraintError error_of(const Constraint& constraint, const Pose& from, const Pose& to);

/// Poses in one frame, and measured relative poses (constraints) between them. Optimising minimises the sum
/// of squared errors of odometry and of Welsch's function of those of loop closures, whose scale is graduated
/// from three times their median error to kLoopScale as in section 5 of Zhang et al., by Gauss-Newton steps
/// that descend. The first node (of the least number) stays. The result depends on neither threads nor the
/// order of insertion of nodes.
class PoseGraph {
 public:
  void add(std::uint32_t node, const Pose& map_from_node) { nodes_[node] = map_from_node; }
  /// Both nodes are in the graph. A second constraint of the same kind between them is combined with the
  /// first.
  void connect(Constraint constraint);
  /// The same where there is none of that kind between them yet; faster, for none is searched for.
  void connect_new(const Constraint& constraint);
  /// Removes a node: its constraints are chained through the neighbour of largest information, so that a
  /// chain loses nothing. Loop closures that the rest of the graph contradicts are removed with it.
  void remove(std::uint32_t node);

  /// Removes the node `gone` in favour of another one of the same place; `between` is their relative pose.
  /// Constraints of the removed node become constraints of the other one, unless that has one with the same
  /// neighbour already: so a map that is driven through repeatedly neither drifts nor gains information from
  /// the same surfaces. Loop closures that the rest of the graph contradicts are removed with it.
  void replace(std::uint32_t gone, Constraint between);

  /// The largest motion of any node by the optimisation.
  struct Change {
    double metres = 0, radians = 0;
  };
  Change optimise();
  /// Takes poses that were optimised elsewhere. Nodes added since move with the last of the optimised nodes;
  /// poses of nodes removed since are ignored.
  void move(const std::map<std::uint32_t, Pose>& map_from_node);

  /// The covariance of one pose in the frame of another, right perturbation; very large where no constraints
  /// connect them.
  Matrix6 covariance(std::uint32_t from, std::uint32_t to) const;
  /// A path of at most `most` constraints from one node to another, chained: its covariance is an upper bound
  /// of that of the graph, without a solution of it. Nothing where there is no such path.
  std::optional<Constraint> way(std::uint32_t from, std::uint32_t to, int most) const;
  /// Welsch's weight of a constraint at the last scale (0 to 1); 1 of odometry.
  double weight(const Constraint& constraint) const;

  /// The connected components, that of the first node first.
  std::vector<PoseGraph> parts() const;
  bool contains(std::uint32_t node) const { return nodes_.count(node) > 0; }
  const std::map<std::uint32_t, Pose>& nodes() const { return nodes_; }
  const std::vector<Constraint>& constraints() const { return constraints_; }

  /// Standard deviations: beyond, the weight of a loop closure decreases. 0.84 of its weight is left at the
  /// expected error of six degrees of freedom, 0.6 at that which one in a hundred exceeds.
  static constexpr double kLoopScale = 4.0;

 private:
  std::map<std::uint32_t, Pose> nodes_;
  std::vector<Constraint> constraints_;
};

}  // namespace scanlock
