// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/loop_closure.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "../odometry/lost_points.hpp"
#include "../odometry/room.hpp"
#include "mapping/mapper.hpp"

namespace scanlock {
namespace {

/// A keyframe in the hall: the points seen from `truth`, with the pose `believed`.
ArchivedKeyframe keyframe(std::uint32_t id, const Pose& truth, const Pose& believed) {
  PointCloud points = hall_scan(truth, Vector6::Zero(), 0, id).points;
  points.time.clear();
  ArchivedKeyframe k;
  k.id = id;
  k.reach = 8;
  k.map_from_body = believed;
  k.points = std::move(points);
  return k;
}

Matrix6 covariance(double metres, double radians) {
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  return sigma.cwiseAbs2().asDiagonal();
}

Pose first_visit(std::uint32_t i) {
  return at(-5 + 1.4 * i, 0.3, 0.1 * i);
}
Pose second_visit(std::uint32_t i) {
  return at(-4.5 + 1.4 * i, -0.6, 2.0);
}

/// Two visits of the hall, six keyframes each. The poses of the second visit have the error `off` and
/// standard deviations of `metres` and `radians`; the last but one of its keyframes is the newest of the
/// request.
ClosureRequest two_visits(const Pose& off, double metres, double radians) {
  ClosureRequest request;
  request.graph.add(kOriginNode, Pose::Identity());
  for (std::uint32_t i = 1; i < 7; ++i) {
    request.earlier.push_back(keyframe(i, first_visit(i), first_visit(i)));
    request.recent.push_back(keyframe(10 + i, second_visit(i), off * second_visit(i)));
  }
  std::uint32_t before = kOriginNode;
  for (const auto* visit : {&request.earlier, &request.recent}) {
    for (const ArchivedKeyframe& k : *visit) {
      request.graph.add(k.id, k.map_from_body);
      Constraint c;
      c.from = before;
      c.to = k.id;
      c.from_to = request.graph.nodes().at(before).inverse() * k.map_from_body;
      c.information = inverse(k.id == 11 ? covariance(metres, radians) : covariance(0.002, 0.0005));
      request.graph.connect(c);
      before = k.id;
    }
  }
  request.keyframe = request.recent.back();
  request.recent.pop_back();
  request.nearest = request.nearest_keyframe = 6;
  request.revisits = {{15, 5, 5}, {16, 6, 6}};
  request.own_from_nearest = first_visit(6);
  request.voxel = 0.15;
  request.usual.sigma = 0.03;
  request.usual_information = inverse(covariance(1e-6, 1e-6));
  return request;
}

}  // namespace

TEST_CASE("two closures that agree close a loop to centimetres") {
  const Pose off = at(0.4, -0.3, 0.05);
  ClosureRequest request = two_visits(off, 0.3, 0.04);
  const ClosureAnswer second = close_loop(request, {});
  CAPTURE(second.reason);
  CHECK(second.outcome == ClosureOutcome::kPending);
  CHECK(second.closure.from == 6);
  CHECK(second.closure.to == 16);
  const Pose truth = first_visit(6).inverse() * second_visit(6);
  const Vector6 error = se3_log(truth.inverse() * second.closure.from_to);
  CHECK(error.head<3>().norm() < 0.02);
  CHECK(error.tail<3>().norm() < 0.004);
  CHECK(error.dot(second.closure.information * error) < kOnceInThousand);

  Constraint before = second.closure;
  before.from = 4;
  before.to = 15;
  before.from_to = first_visit(4).inverse() * second_visit(5);
  request.pending = before;
  const ClosureAnswer accepted = close_loop(request, {});
  REQUIRE(accepted.outcome == ClosureOutcome::kAccepted);
  for (std::uint32_t i = 1; i < 7; ++i)
    CHECK(near(accepted.map_from_node.at(10 + i), second_visit(i), 0.03, 0.006));
  REQUIRE(accepted.revisits.size() == 2);
  for (const Revisit& revisit : accepted.revisits) CHECK(revisit.covariance.trace() < 0.01 * 0.3 * 0.3);
  CHECK(accepted.drift.trace() < 0.01 * 0.3 * 0.3);

  request.pending->from_to.translation().x() += 0.2;
  CHECK(close_loop(request, {}).outcome == ClosureOutcome::kPending);
}

TEST_CASE("a closure is refused beyond the error of the odometry, and where the surroundings differ") {
  CHECK(close_loop(two_visits(at(0.4, -0.3, 0.05), 0.03, 0.004), {}).outcome == ClosureOutcome::kRefused);
  ClosureRequest request = two_visits(Pose::Identity(), 0.3, 0.04);
  for (ArchivedKeyframe& k : request.earlier) {  // another hall, half as long
    PointCloud other = *k.points.cloud();
    for (float& x : other.x) x *= 0.5F;
    k.points = std::move(other);
  }
  const ClosureAnswer answer = close_loop(request, {});
  CAPTURE(answer.reason);
  CHECK(answer.outcome == ClosureOutcome::kRefused);
}

TEST_CASE("a closure that would add no information is not aligned") {
  ClosureRequest request = two_visits(Pose::Identity(), 0.01, 0.001);
  request.usual_information = inverse(covariance(0.02, 0.004));
  const ClosureAnswer known = close_loop(request, {});
  CHECK(known.outcome == ClosureOutcome::kKnown);
  REQUIRE(known.revisits.size() == 2);
  CHECK((known.revisits[0].covariance - request.graph.covariance(5, 15)).norm() < 1e-9);
  // Along a corridor a closure has no information, so that a large variance along it does not make the
  // closure worthwhile.
  Matrix6 corridor = inverse(covariance(0.02, 0.004));
  corridor(0, 0) = 0;
  Matrix6 unknown_along = covariance(0.01, 0.001);
  unknown_along(0, 0) = 1e6;
  CHECK_FALSE(is_worthwhile(unknown_along, corridor));
  unknown_along(1, 1) = 0.1;
  CHECK(is_worthwhile(unknown_along, corridor));
  request.pending = Constraint();  // two closures in a row are required
  CHECK(close_loop(request, {}).outcome != ClosureOutcome::kKnown);
}

TEST_CASE("requests for points that cannot be read find nothing and report the fault of the map") {
  ClosureRequest request = two_visits(Pose::Identity(), 0.5, 0.05);
  request.serial = 7;
  for (ArchivedKeyframe& k : request.earlier) k.points = lost_points();
  RecoveryRequest search;
  search.serial = 8;
  search.source = *request.keyframe.points.cloud();
  search.target.source_radius = search.target.radius = 20;
  search.target.voxel = 0.5;
  search.target.places = request.earlier;
  JoinRequest join;
  join.closure = request;
  join.search = search;
  const std::string why = "yard.map: was changed";
  MapWorker worker{TrackerConfig{}};
  const auto closure = std::get<ClosureAnswer>(worker.work(request));
  CHECK(closure.serial == 7);
  CHECK(closure.keyframe == request.keyframe.id);
  CHECK(closure.outcome == ClosureOutcome::kRefused);
  CHECK(closure.map_fault == why);
  const auto found = std::get<RecoveryAnswer>(worker.work(search));
  CHECK(found.serial == 8);
  CHECK(found.verdict == PlaceVerdict::kNotHere);
  CHECK(found.map_fault == why);
  const auto joined = std::get<JoinAnswer>(worker.work(join));
  CHECK(joined.search.serial == 8);
  CHECK(joined.closure.outcome == ClosureOutcome::kRefused);
  CHECK(joined.closure.map_fault == why);
}

}  // namespace scanlock
