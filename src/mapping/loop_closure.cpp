// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/loop_closure.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

// Information of a velocity of 0: archived points are deskewed, as if seen at one instant.
constexpr double kStill = 1e8;
// Information added so that directions which no surface constrains stay invertible.
constexpr double kNothing = 1e-6;
constexpr double kWorthwhile = 2.0;  // least ratio of the graph's variance to that of a closure

PreparedScan prepared(const ClosureRequest& request) {
  PreparedScan scan;
  scan.source = scan.fine = *request.keyframe.points.cloud();
  scan.whole = scan.source.size();
  scan.voxel = request.voxel;
  scan.median_range = static_cast<double>(request.keyframe.reach);
  scan.planar = request.planar;
  return scan;
}

Matrix6 with_floor(const Matrix6& covariance) {
  return covariance + kPoseFloor * kPoseFloor * Matrix6::Identity();
}

MotionPrior at_rest(const Pose& expected, const Matrix6& covariance) {
  MotionPrior prior;
  prior.mean.pose = expected;
  prior.information.topLeftCorner<6, 6>() = inverse(with_floor(covariance));
  prior.information.bottomRightCorner<6, 6>() = kStill * Matrix6::Identity();
  return prior;
}

Attempt align(const ClosureRequest& request, const std::vector<ArchivedKeyframe>& map, const Pose& expected,
              const Matrix6& covariance, const TrackerConfig& config) {
  Odometer odometer(config);
  odometer.set_planar(request.planar);
  odometer.reload(map, expected.translation(), request.voxel);
  odometer.set_usual(request.usual);
  return odometer.look_far(prepared(request), at_rest(expected, covariance));
}

/// Sets the covariances of the revisits. Returns that of the keyframe's pose in the map's frame.
Matrix6 measure(const PoseGraph& graph, std::uint32_t keyframe, std::vector<Revisit>* revisits) {
  std::vector<PoseGraph::Pair> pairs;
  for (const Revisit& revisit : *revisits) pairs.emplace_back(revisit.nearest, revisit.keyframe);
  pairs.emplace_back(kOriginNode, keyframe);
  const std::vector<RelativePose> known = graph.relative(pairs);
  for (std::size_t i = 0; i < revisits->size(); ++i) (*revisits)[i].covariance = known[i].covariance;
  return known.back().covariance;
}

}  // namespace

std::vector<ArchivedKeyframe> nearest_to(const Eigen::Vector3d& position, double reach,
                                         const std::vector<ArchivedKeyframe>& keyframes,
                                         const std::function<bool(const ArchivedKeyframe&)>& is_wanted,
                                         std::size_t most) {
  std::vector<std::pair<double, const ArchivedKeyframe*>> near;
  for (const ArchivedKeyframe& k : keyframes) {
    const double distance = (k.map_from_body.translation() - position).norm();
    if (distance <= reach && is_wanted(k)) near.emplace_back(distance, &k);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  near.resize(std::min(near.size(), most));
  std::vector<ArchivedKeyframe> result;
  for (const auto& [distance, k] : near) result.push_back(*k);
  return result;
}

std::optional<FoundClosure> find_closure(const ClosureRequest& request, const Pose& expected,
                                         const Matrix6& covariance, const TrackerConfig& config,
                                         std::string* reason) {
  const Attempt here =
      align(request, request.recent, request.keyframe.map_from_body, Matrix6::Zero(), config);
  const Attempt there = align(request, request.earlier, expected, covariance, config);
  const Pose& found = there.alignment.moving.pose;
  const Vector6 moved = se3_log(expected.inverse() * found);
  const double gap = moved.dot(inverse(with_floor(covariance)) * moved);
  char text[160];
  std::snprintf(text, sizeof text,
                "inlier ratio %.2f (%.2f in the recent map), corrected by %.3f m and %.2f deg, squared "
                "Mahalanobis distance %.1f",
                there.health.inlier_ratio, here.health.inlier_ratio, moved.head<3>().norm(),
                moved.tail<3>().norm() / kDegree, gap);
  *reason = text;
  // No bound by earlier scans: the recent keyframes give the usual inlier ratio.
  const double any_score = std::numeric_limits<double>::infinity();
  Health health = there.health;
  health.median_inlier_ratio = here.health.inlier_ratio;
  if (!explains(there, any_score) || !has_usual_inlier_ratio(health) || !(gap < kOnceInThousand))
    return std::nullopt;
  Constraint closure;
  closure.from = request.nearest;
  closure.to = request.keyframe.id;
  closure.from_to = request.own_from_nearest.inverse() * found;
  closure.information = there.information() + kNothing * Matrix6::Identity();
  if (request.planar) {
    for (const int axis : {2, 3, 4}) {  // z, roll, pitch: a planar sensor does not leave its plane
      closure.information.row(axis).setZero();
      closure.information.col(axis).setZero();
      closure.information(axis, axis) = 1 / (kPoseFloor * kPoseFloor);
    }
  }
  closure.loop_closure = true;
  return FoundClosure{closure, there.health.energy - here.health.energy};
}

void learn_usual(const ClosureRequest& request, Odometer* odometer) {
  const Pose& here = request.keyframe.map_from_body;
  odometer->reload(request.recent, here.translation(), request.voxel);
  odometer->set_pose(here);
  const Attempt attempt = odometer->align(prepared(request), at_rest(here, Matrix6::Zero()), Reach::kNear);
  if (explains(attempt, std::numeric_limits<double>::infinity())) odometer->accept(attempt);
}

bool agree(const RelativePose& earlier_visit, const RelativePose& this_visit, const Constraint& a,
           const Constraint& b) {
  const Pose& a_from_b = this_visit.from_to;
  const Vector6 apart = se3_log(b.from_to.inverse() * earlier_visit.from_to.inverse() * a.from_to * a_from_b);
  const Matrix6 recent = adjoint(a_from_b.inverse()), earlier = adjoint(b.from_to.inverse());
  const Matrix6 covariance = recent * inverse(a.information) * recent.transpose() + inverse(b.information) +
                             this_visit.covariance + earlier * earlier_visit.covariance * earlier.transpose();
  return apart.dot(inverse(covariance) * apart) < kOnceInThousand;
}

bool is_worthwhile(const Matrix6& covariance, const Matrix6& usual_information) {
  const Matrix6 half = cholesky(covariance);
  const Matrix6 scaled = half.transpose() * usual_information * half;
  return symmetric_eigen(scaled).values.maxCoeff() >= kWorthwhile;
}

ClosureAnswer close_loop(const ClosureRequest& request, const TrackerConfig& config) {
  ClosureAnswer answer;
  answer.serial = request.serial;
  answer.keyframe = request.keyframe.id;
  answer.nearest = request.nearest;
  answer.nearest_keyframe = request.nearest_keyframe;
  const std::optional<Constraint>& before = request.pending;
  const bool there = before && request.graph.contains(before->from) && request.graph.contains(before->to);
  std::vector<PoseGraph::Pair> pairs{{request.nearest, request.keyframe.id}};
  const PoseGraph::Pair ends = pairs.front();
  if (there) pairs.insert(pairs.end(), {{before->from, ends.first}, {before->to, ends.second}});
  const std::vector<RelativePose> known = request.graph.relative(pairs);
  const Matrix6& covariance = known.front().covariance;
  if (!before && !is_worthwhile(covariance, request.usual_information)) {
    answer.outcome = ClosureOutcome::kKnown;
    answer.revisits = request.revisits;
    measure(request.graph, request.keyframe.id, &answer.revisits);
    return answer;
  }
  const std::optional<FoundClosure> found =
      find_closure(request, request.keyframe.map_from_body, covariance, config, &answer.reason);
  if (!found) return answer;
  const Constraint& closure = answer.closure = found->constraint;
  answer.outcome = ClosureOutcome::kPending;
  if (!there || !agree(known[1], known[2], *before, closure)) return answer;
  answer.outcome = ClosureOutcome::kAccepted;
  PoseGraph graph = request.graph;
  graph.connect(*before);
  graph.connect(closure);
  graph.optimise();
  answer.map_from_node = graph.nodes();
  answer.revisits = request.revisits;
  answer.drift = measure(graph, request.keyframe.id, &answer.revisits);
  return answer;
}

}  // namespace scanlock
