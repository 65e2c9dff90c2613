// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/pose_graph.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

#include "icp/welsch.hpp"

namespace scanlock {
namespace {

constexpr int kMostSteps = 30;  // Gauss-Newton steps at the last scale
// Steps at each larger scale, which only has to reach the basin of the next.
constexpr int kUpperSteps = 2;
constexpr double kSettled = 1e-6;  // metres and radians: a smaller step ends the steps of a scale
constexpr double kFixed = 1e14;    // information that holds the first node
constexpr double kUnknown = 1e-8;  // information of unconnected nodes: a covariance of (10 km)^2
// A loop closure of at most this weight is contradicted by the rest of the graph.
constexpr double kContradicted = 0.1;

double squared_error(const Constraint& constraint, const Vector6& error) {
  return error.dot(constraint.information * error);
}

using Sparse = Eigen::SparseMatrix<double>;
/// Without an order of its own: System orders the nodes, of which there are six times fewer than unknowns.
using Solver = Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>>;

/// The linear system. The place of a node is its position in the order of elimination.
class System {
 public:
  System(const std::map<std::uint32_t, Pose>& nodes, const std::vector<Constraint>& constraints)
      : constraints_(constraints) {
    order(nodes);
    poses.resize(nodes.size());
    for (const auto& [node, pose] : nodes) poses[static_cast<std::size_t>(place(node))] = pose;
    for (const Constraint& c : constraints) ends_.emplace_back(place(c.from), place(c.to));
    lay_out();
  }

  Eigen::Index place(std::uint32_t node) const { return places_.at(node); }
  const Pose& pose(Eigen::Index place) const { return poses[static_cast<std::size_t>(place)]; }

  /// The energy of all constraints, with Welsch's function at scale `nu` for loop closures.
  double energy(double nu) const {
    double sum = 0;
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      const Constraint& c = constraints_[i];
      const double s = squared_error(c, error(i));
      sum += c.loop_closure ? nu * nu * welsch(s, nu) : 0.5 * s;
    }
    return sum;
  }

  /// Gauss-Newton matrix and gradient; the node at `fixed` is held.
  void linearise(double nu, Eigen::Index fixed) {
    gradient.setZero(hessian.cols());
    std::fill_n(hessian.valuePtr(), hessian.nonZeros(), 0.0);
    hessian.diagonal().setConstant(kUnknown);
    hessian.diagonal().segment<6>(6 * fixed).array() += kFixed;
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      const Constraint& c = constraints_[i];
      const auto [from, to] = ends_[i];
      const ConstraintError e = error_of(c, pose(from), pose(to));
      const double weight = c.loop_closure ? welsch_weight(squared_error(c, e.error), nu) : 1.0;
      const Matrix6 by_from = weight * c.information * e.by_from, by_to = weight * c.information * e.by_to;
      gradient.segment<6>(6 * from) += by_from.transpose() * e.error;
      gradient.segment<6>(6 * to) += by_to.transpose() * e.error;
      add_upper(from, from, e.by_from.transpose() * by_from);
      add_upper(to, to, e.by_to.transpose() * by_to);
      if (from < to)
        add_upper(from, to, e.by_from.transpose() * by_to);
      else
        add_upper(to, from, e.by_to.transpose() * by_from);
    }
  }

  /// The poses after a step.
  std::vector<Pose> moved(const Eigen::VectorXd& step) const {
    std::vector<Pose> result = poses;
    for (std::size_t i = 0; i < poses.size(); ++i)
      result[i] = renormalised(poses[i] * se3_exp(step.segment<6>(static_cast<Eigen::Index>(6 * i))));
    return result;
  }

  /// Takes one step that lowers the energy, damped as much as that needs. Returns its largest component; 0
  /// where no step does.
  double descend(double nu, Eigen::Index fixed) {
    linearise(nu, fixed);
    if (!analysed_) solver_.analyzePattern(hessian);
    analysed_ = true;
    const double before = energy(nu);
    for (double damping = 0; damping < 1e9; damping = std::max(10 * damping, 1e-4)) {
      if (damping > 0) {
        Sparse damped = hessian;
        damped.diagonal() *= 1 + damping;
        solver_.factorize(damped);
      } else {
        solver_.factorize(hessian);
      }
      if (solver_.info() != Eigen::Success) continue;
      const Eigen::VectorXd step = -solver_.solve(gradient);
      std::vector<Pose> there = moved(step);
      std::swap(poses, there);
      if (energy(nu) <= before) return step.cwiseAbs().maxCoeff();
      std::swap(poses, there);
    }
    return 0;
  }

  double median_loop_error() const {
    std::vector<double> errors;
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      if (constraints_[i].loop_closure) errors.push_back(std::sqrt(squared_error(constraints_[i], error(i))));
    }
    if (errors.empty()) return 0;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
  }

  std::vector<Pose> poses;
  Sparse hessian;  // its upper triangle
  Eigen::VectorXd gradient;

 private:
  Vector6 error(std::size_t i) const {
    const auto [from, to] = ends_[i];
    return se3_log(constraints_[i].from_to.inverse() * pose(from).inverse() * pose(to));
  }

  /// The places: an order of the nodes in which few entries of the factor are not zero.
  void order(const std::map<std::uint32_t, Pose>& nodes) {
    for (const auto& [node, pose] : nodes) places_.emplace(node, static_cast<Eigen::Index>(places_.size()));
    const auto n = static_cast<Eigen::Index>(nodes.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);  // else AMD takes i for dense
    for (const Constraint& c : constraints_) {
      entries.emplace_back(place(c.from), place(c.to), 1.0);
      entries.emplace_back(place(c.to), place(c.from), 1.0);
    }
    Sparse neighbours(n, n);
    neighbours.setFromTriplets(entries.begin(), entries.end());
    Eigen::AMDOrdering<int>::PermutationType earlier;
    Eigen::AMDOrdering<int>()(neighbours, earlier);
    const Eigen::AMDOrdering<int>::PermutationType later = earlier.inverse();
    for (auto& [node, place] : places_) place = later.indices()[place];
  }

  /// Lays out the entries of the upper triangle once; their places stay the same.
  void lay_out() {
    std::vector<std::pair<Eigen::Index, Eigen::Index>> blocks;  // column, row
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(poses.size()); ++i) blocks.emplace_back(i, i);
    for (const auto& [from, to] : ends_) blocks.emplace_back(std::max(from, to), std::min(from, to));
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    const auto n = static_cast<Eigen::Index>(6 * poses.size());
    hessian.resize(n, n);
    hessian.reserve(static_cast<Eigen::Index>(36 * blocks.size()));
    for (auto column = blocks.begin(); column != blocks.end();) {
      const auto end =
          std::find_if(column, blocks.end(), [&](const auto& b) { return b.first != column->first; });
      for (int j = 0; j < 6; ++j) {
        hessian.startVec(6 * column->first + j);
        for (auto b = column; b != end; ++b) {
          for (int i = 0; i <= (b->second == b->first ? j : 5); ++i)
            hessian.insertBack(6 * b->second + i, 6 * b->first + j) = 0;
        }
      }
      column = end;
    }
    hessian.finalize();
  }

  void add_upper(Eigen::Index row, Eigen::Index column, const Matrix6& block) {
    for (int j = 0; j < 6; ++j) {
      double* const entries = &hessian.coeffRef(6 * row, 6 * column + j);  // contiguous, see lay_out()
      for (int i = 0; i <= (row == column ? j : 5); ++i) entries[i] += block(i, j);
    }
  }

  const std::vector<Constraint>& constraints_;
  std::map<std::uint32_t, Eigen::Index> places_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> ends_;  // places of each constraint's nodes
  Solver solver_;
  bool analysed_ = false;
};

bool touches(const Constraint& c, std::uint32_t node) {
  return c.from == node || c.to == node;
}

}  // namespace

Constraint reversed(const Constraint& constraint) {
  Constraint result = constraint;
  std::swap(result.from, result.to);
  result.from_to = constraint.from_to.inverse();
  // (Z exp(e))^-1 = Z^-1 exp(-Ad(Z) e)
  const Matrix6 back = adjoint(result.from_to);
  result.information = back.transpose() * constraint.information * back;
  return result;
}

Constraint chained(const Constraint& ab, const Constraint& bc) {
  Constraint result;
  result.from = ab.from;
  result.to = bc.to;
  result.from_to = renormalised(ab.from_to * bc.from_to);
  result.loop_closure = ab.loop_closure || bc.loop_closure;
  // Z1 exp(e1) Z2 exp(e2) = Z1 Z2 exp(Ad(Z2^-1) e1) exp(e2)
  const Matrix6 onwards = adjoint(bc.from_to.inverse());
  result.information =
      inverse(Matrix6(onwards * inverse(ab.information) * onwards.transpose() + inverse(bc.information)));
  result.information = 0.5 * (result.information + result.information.transpose()).eval();
  return result;
}

ConstraintError error_of(const Constraint& constraint, const Pose& from, const Pose& to) {
  const Pose from_to = from.inverse() * to;
  ConstraintError result;
  result.error = se3_log(constraint.from_to.inverse() * from_to);
  // log(E exp(d)) = log E + J_r(log E)^-1 d, and J_r(x) = J_l(-x).
  result.by_to = inverse(se3_left_jacobian(-result.error));
  result.by_from = -result.by_to * adjoint(from_to.inverse());
  return result;
}

void PoseGraph::connect_new(const Constraint& constraint) {
  if (constraint.from == constraint.to) return;
  constraints_.push_back(constraint.from > constraint.to ? reversed(constraint) : constraint);
}

void PoseGraph::connect(Constraint constraint) {
  if (constraint.from > constraint.to) constraint = reversed(constraint);
  const auto same = std::find_if(constraints_.begin(), constraints_.end(), [&](const Constraint& c) {
    return c.from == constraint.from && c.to == constraint.to && c.loop_closure == constraint.loop_closure;
  });
  if (same == constraints_.end()) {
    connect_new(constraint);
    return;
  }
  const Vector6 apart = se3_log(same->from_to.inverse() * constraint.from_to);
  same->information += constraint.information;
  same->from_to =
      renormalised(same->from_to * se3_exp(solve(same->information, constraint.information * apart)));
}

void PoseGraph::replace(std::uint32_t gone, Constraint between) {
  if (between.to != gone) between = reversed(between);
  const std::uint32_t kept = between.from;
  std::vector<Constraint> stay, moved;
  for (const Constraint& c : constraints_) {
    if (!touches(c, gone)) {
      stay.push_back(c);
    } else if (!touches(c, kept) && weight(c) > kContradicted) {
      moved.push_back(chained(between, c.from == gone ? c : reversed(c)));
      moved.back().loop_closure = c.loop_closure;
    }
  }
  const auto is_new = [&](const Constraint& c) {
    return std::none_of(stay.begin(), stay.end(), [&](const Constraint& known) {
      return touches(known, kept) && touches(known, c.to);
    });
  };
  moved.erase(std::remove_if(moved.begin(), moved.end(), [&](const Constraint& c) { return !is_new(c); }),
              moved.end());
  constraints_ = std::move(stay);
  nodes_.erase(gone);
  for (const Constraint& c : moved) connect(c);
}

void PoseGraph::remove(std::uint32_t node) {
  std::vector<Constraint> touching;  // all directed away from the node
  for (const Constraint& c : constraints_) {
    if (touches(c, node) && weight(c) > kContradicted) touching.push_back(c.from == node ? c : reversed(c));
  }
  constraints_.erase(std::remove_if(constraints_.begin(), constraints_.end(),
                                    [&](const Constraint& c) { return touches(c, node); }),
                     constraints_.end());
  nodes_.erase(node);
  const auto uncertainty = [](const Constraint& c) { return inverse(c.information).trace(); };
  const auto best = std::min_element(
      touching.begin(), touching.end(),
      [&](const Constraint& a, const Constraint& b) { return uncertainty(a) < uncertainty(b); });
  for (auto c = touching.begin(); c != touching.end(); ++c) {
    if (c == best) continue;
    Constraint through = chained(reversed(*best), *c);
    through.loop_closure = c->loop_closure;
    connect(through);
  }
}

void PoseGraph::move(const std::map<std::uint32_t, Pose>& map_from_node) {
  if (map_from_node.empty()) return;
  const auto last = map_from_node.rbegin();
  const auto here = nodes_.find(last->first);
  const Pose later = here == nodes_.end() ? Pose::Identity() : Pose(last->second * here->second.inverse());
  for (auto& [node, pose] : nodes_) {
    const auto moved = map_from_node.find(node);
    if (moved != map_from_node.end())
      pose = moved->second;
    else if (node > last->first)
      pose = renormalised(later * pose);
  }
}

PoseGraph::Change PoseGraph::optimise() {
  Change change;
  if (nodes_.empty()) return change;
  System system(nodes_, constraints_);
  const Eigen::Index first = system.place(nodes_.begin()->first);
  double nu = std::max(3.0 * system.median_loop_error(), kLoopScale);
  while (true) {
    const bool last = nu <= kLoopScale;
    for (int step = 0; step < (last ? kMostSteps : kUpperSteps); ++step) {
      if (system.descend(nu, first) <= kSettled) break;
    }
    if (last) break;
    nu = std::max(0.5 * nu, kLoopScale);
  }
  for (auto& [node, pose] : nodes_) {
    const Pose& optimum = system.pose(system.place(node));
    const Vector6 moved = se3_log(pose.inverse() * optimum);
    change.metres = std::max(change.metres, moved.head<3>().norm());
    change.radians = std::max(change.radians, moved.tail<3>().norm());
    pose = optimum;
  }
  return change;
}

std::vector<RelativePose> PoseGraph::relative(const std::vector<Pair>& pairs) const {
  System system(nodes_, constraints_);
  system.linearise(kLoopScale, system.place(pairs.front().first));
  const Solver solver(system.hessian);
  // The joint covariance of the nodes of all pairs.
  std::map<std::uint32_t, Eigen::Index> nodes;
  for (const auto& [from, to] : pairs) nodes[from] = nodes[to] = 0;
  Eigen::Index count = 0;
  for (auto& [node, at] : nodes) at = 6 * count++;
  Eigen::MatrixXd joint(6 * count, 6 * count), unit = Eigen::MatrixXd::Zero(system.gradient.size(), 6);
  for (const auto& [node, column] : nodes) {
    unit.block<6, 6>(6 * system.place(node), 0).setIdentity();
    const Eigen::MatrixXd solution = solver.solve(unit);
    unit.block<6, 6>(6 * system.place(node), 0).setZero();
    for (const auto& [other, row] : nodes)
      joint.block<6, 6>(row, column) = solution.block<6, 6>(6 * system.place(other), 0);
  }
  std::vector<RelativePose> result;
  for (const auto& [from, to] : pairs) {
    RelativePose& relative = result.emplace_back();
    relative.from_to = nodes_.at(from).inverse() * nodes_.at(to);
    // (F exp(f))^-1 T exp(t) = F^-1 T exp(t - Ad(T^-1 F) f)
    Eigen::Matrix<double, 6, 12> by_both;
    by_both << -adjoint(relative.from_to.inverse()), Matrix6::Identity();
    const Eigen::Index f = nodes.at(from), t = nodes.at(to);
    Eigen::Matrix<double, 12, 12> both;
    both << joint.block<6, 6>(f, f), joint.block<6, 6>(f, t), joint.block<6, 6>(t, f),
        joint.block<6, 6>(t, t);
    const Matrix6 covariance = by_both * both * by_both.transpose();
    relative.covariance = 0.5 * (covariance + covariance.transpose());
  }
  return result;
}

std::vector<PoseGraph> PoseGraph::parts() const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> neighbours;
  for (const Constraint& c : constraints_) {
    neighbours[c.from].push_back(c.to);
    neighbours[c.to].push_back(c.from);
  }
  std::map<std::uint32_t, std::size_t> part_of;
  std::vector<PoseGraph> parts;
  for (const auto& [first, pose] : nodes_) {
    if (part_of.count(first) > 0) continue;
    std::vector<std::uint32_t> border{first};
    while (!border.empty()) {
      const std::uint32_t node = border.back();
      border.pop_back();
      if (!part_of.emplace(node, parts.size()).second) continue;
      border.insert(border.end(), neighbours[node].begin(), neighbours[node].end());
    }
    parts.emplace_back();
  }
  for (const auto& [node, pose] : nodes_) parts[part_of.at(node)].add(node, pose);
  for (const Constraint& c : constraints_) parts[part_of.at(c.from)].constraints_.push_back(c);
  return parts;
}

double PoseGraph::weight(const Constraint& constraint) const {
  if (!constraint.loop_closure) return 1;
  const ConstraintError e = error_of(constraint, nodes_.at(constraint.from), nodes_.at(constraint.to));
  return welsch_weight(squared_error(constraint, e.error), kLoopScale);
}

}  // namespace scanlock
