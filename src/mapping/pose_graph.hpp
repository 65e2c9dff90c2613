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
/// The measurement of c in a, by those of b in a and of c in b; their errors are independent.
Constraint chained(const Constraint& ab, const Constraint& bc);

/// The error of a constraint, and its derivatives by perturbations from exp(d) and to exp(d).
struct ConstraintError {
  Vector6 error = Vector6::Zero();  ///< log(from_to^-1 from^-1 to)
  Matrix6 by_from = Matrix6::Zero(), by_to = Matrix6::Zero();
};
ConstraintError error_of(const Constraint& constraint, const Pose& from, const Pose& to);

/// Poses in one frame, and what was measured between them. Optimising minimises the sum of squared errors of
/// odometry and of Welsch's function of those of loop closures, whose scale is graduated from three times
/// their median error to kLoopScale as in section 5 of Zhang et al., by Gauss-Newton steps that descend. The
/// first node (of the least number) stays. The result depends on neither threads nor the order of insertion
/// of nodes.
class PoseGraph {
 public:
  void add(std::uint32_t node, const Pose& map_from_node) { nodes_[node] = map_from_node; }
  /// Between nodes that are there. A second measurement of the same kind between them joins the first.
  void connect(Constraint constraint);
  /// Likewise, where there is no other of the same kind between them: what is there already is not searched.
  void connect_new(const Constraint& constraint);
  /// Takes a node away; what was measured through it goes on, by way of the neighbour known best to it: of
  /// a chain nothing is lost. Loop closures that the rest contradicts go with it.
  void remove(std::uint32_t node);

  /// The node `gone` leaves, for another one shows the same; `between` says how the two lie to each other.
  /// What was measured of it is from now on one of the node that stays, unless that one was measured against
  /// the same neighbour: a map that is driven through again and again neither drifts nor gets surer of itself
  /// by the same surfaces. Loop closures that the rest contradicts go with it.
  void replace(std::uint32_t gone, Constraint between);

  /// How far the optimum moved any node from where it was.
  struct Change {
    double metres = 0, radians = 0;
  };
  Change optimise();
  /// Poses that were optimised elsewhere. Nodes that came later move with the last one that is among them,
  /// those that have left meanwhile are ignored.
  void move(const std::map<std::uint32_t, Pose>& map_from_node);

  /// The covariance of one pose in the frame of another, right perturbation; huge where nothing connects
  /// them.
  Matrix6 covariance(std::uint32_t from, std::uint32_t to) const;
  /// A way of at most so many constraints from one node to another, chained: what it leaves open is more than
  /// what the graph does, and costs no solution of it. None where there is no such way.
  std::optional<Constraint> way(std::uint32_t from, std::uint32_t to, int most) const;
  /// Welsch's weight of a constraint at the last scale (0 to 1); 1 of odometry.
  double weight(const Constraint& constraint) const;

  /// The parts of it that nothing connects, the first node's first.
  std::vector<PoseGraph> parts() const;
  bool contains(std::uint32_t node) const { return nodes_.count(node) > 0; }
  const std::map<std::uint32_t, Pose>& nodes() const { return nodes_; }
  const std::vector<Constraint>& constraints() const { return constraints_; }

  /// Standard deviations: beyond, a loop closure counts less and less. 0.84 of its weight is left at the
  /// expected error of six degrees of freedom, 0.6 at that which one in a hundred exceeds.
  static constexpr double kLoopScale = 4.0;

 private:
  std::map<std::uint32_t, Pose> nodes_;
  std::vector<Constraint> constraints_;
};

}  // namespace scanlock
