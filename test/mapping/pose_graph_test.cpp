// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/pose_graph.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

namespace scanlock {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : rng_(seed) {}
  Vector6 vector(double metres, double radians) {
    Vector6 v;
    for (int i = 0; i < 6; ++i) v[i] = (i < 3 ? metres : radians) * normal_(rng_);
    return v;
  }
  Pose pose(double metres, double radians) { return se3_exp(vector(metres, radians)); }
  Matrix6 information() {
    Matrix6 a;
    for (int i = 0; i < 36; ++i) a(i / 6, i % 6) = normal_(rng_);
    return a * a.transpose() + Matrix6::Identity();
  }
  std::uint32_t below(std::uint32_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(rng_);
  }

 private:
  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
};

Matrix6 information(double metres, double radians) {
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

Constraint measured(std::uint32_t from, std::uint32_t to, const std::vector<Pose>& truth) {
  Constraint c;
  c.from = from;
  c.to = to;
  c.from_to = truth[from].inverse() * truth[to];
  return c;
}

double worst(const PoseGraph& graph, const std::vector<Pose>& truth) {
  double most = 0;
  for (const auto& [node, pose] : graph.nodes())
    most = std::max(most, se3_log(truth[node].inverse() * pose).norm());
  return most;
}

/// Poses along a ring, 2 m apart.
std::vector<Pose> ring(std::uint32_t n) {
  std::vector<Pose> truth(1, Pose::Identity());
  Vector6 step;
  step << 2, 0, 0, 0, 0, 2 * 3.14159265358979 / n;
  while (truth.size() < n) truth.push_back(truth.back() * se3_exp(step));
  return truth;
}

/// The true poses, with noisy odometry constraints from each pose to the next.
PoseGraph chain(const std::vector<Pose>& truth, Random& random) {
  PoseGraph graph;
  for (std::uint32_t i = 0; i < truth.size(); ++i) {
    graph.add(i, truth[i]);
    if (i == 0) continue;
    Constraint c = measured(i - 1, i, truth);
    c.information = 1e4 * random.information();
    graph.connect(c);
  }
  return graph;
}

}  // namespace

TEST_CASE("derivatives of a constraint are those that differences give") {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    Constraint c;
    c.from_to = random.pose(2, 1);
    const Pose from = random.pose(5, 1);
    const Pose to = from * c.from_to * random.pose(0.3, 0.3);
    const ConstraintError e = error_of(c, from, to);
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6 d = 1e-6 * Vector6::Unit(axis);
      const auto difference = [&](const ConstraintError& plus, const ConstraintError& minus) -> Vector6 {
        return (plus.error - minus.error) / 2e-6;
      };
      CHECK((difference(error_of(c, from * se3_exp(d), to), error_of(c, from * se3_exp(-d), to)) -
             e.by_from.col(axis))
                .norm() < 1e-6);
      CHECK((difference(error_of(c, from, to * se3_exp(d)), error_of(c, from, to * se3_exp(-d))) -
             e.by_to.col(axis))
                .norm() < 1e-6);
    }
  }
}

TEST_CASE("a constraint reversed twice is itself, and chained ones have the covariance of many draws") {
  Random random(2);
  Constraint ab;
  ab.from_to = random.pose(3, 1);
  ab.information = 1e6 * random.information();
  const Constraint twice = reversed(reversed(ab));
  CHECK((twice.from_to.matrix() - ab.from_to.matrix()).norm() < 1e-12);
  CHECK((twice.information - ab.information).norm() < 1e-6 * ab.information.norm());

  Constraint bc;
  bc.from_to = random.pose(3, 1);
  bc.information = 1e6 * random.information();
  const Matrix6 root_ab = cholesky(inverse(ab.information)), root_bc = cholesky(inverse(bc.information));
  const Constraint ac = chained(ab, bc), ba = reversed(ab);
  constexpr int kDraws = 20000;
  Matrix6 sum = Matrix6::Zero(), back = Matrix6::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Pose drawn_ab = ab.from_to * se3_exp(root_ab * random.vector(1, 1));
    const Pose drawn = drawn_ab * bc.from_to * se3_exp(root_bc * random.vector(1, 1));
    const Vector6 e = se3_log(ac.from_to.inverse() * drawn);
    const Vector6 r = se3_log(ba.from_to.inverse() * drawn_ab.inverse());
    sum += e * e.transpose() / kDraws;
    back += r * r.transpose() / kDraws;
  }
  const Matrix6 to_unit = cholesky(ac.information), back_to_unit = cholesky(ba.information);
  CHECK((to_unit.transpose() * sum * to_unit - Matrix6::Identity()).norm() < 0.15);
  CHECK((back_to_unit.transpose() * back * back_to_unit - Matrix6::Identity()).norm() < 0.15);
}

TEST_CASE("a graph without noise converges to the truth from far off, in any order of construction") {
  const std::vector<Pose> truth = ring(40);
  std::vector<Pose> results;
  for (const bool backwards : {false, true}) {
    Random random(3);
    PoseGraph graph;
    std::vector<std::uint32_t> order(40);
    for (std::uint32_t i = 0; i < 40; ++i) order[i] = backwards ? 39 - i : i;
    std::vector<Pose> start;
    for (std::uint32_t i = 0; i < 40; ++i)
      start.push_back(i == 0 ? truth[0] : truth[i] * random.pose(1, 0.2));
    for (const std::uint32_t i : order) graph.add(i, start[i]);
    for (std::uint32_t i = 0; i + 1 < 40; ++i) graph.connect(measured(i, i + 1, truth));
    Constraint closure = measured(39, 0, truth);
    closure.loop_closure = true;
    graph.connect(closure);
    const PoseGraph::Change change = graph.optimise();
    CHECK(change.metres > 1);
    CHECK(worst(graph, truth) < 1e-6);
    results.push_back(graph.nodes().at(20));
    CHECK(graph.optimise().metres < 1e-9);
  }
  CHECK(results[0].matrix() == results[1].matrix());
}

TEST_CASE("right loop closures prevail where three in ten are wrong") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const std::vector<Pose> truth = ring(200);
    PoseGraph graph, without_wrong;
    Pose drifted = truth[0];
    graph.add(0, drifted);
    for (std::uint32_t i = 1; i < 200; ++i) {
      Constraint c = measured(i - 1, i, truth);
      c.from_to = c.from_to * random.pose(0.01, 0.002);
      c.information = information(0.01, 0.002);
      drifted = drifted * c.from_to;
      graph.add(i, drifted);
      graph.connect(c);
    }
    without_wrong = graph;
    for (int k = 0; k < 60; ++k) {
      const std::uint32_t i = random.below(200), j = (i + 60 + random.below(80)) % 200;
      Constraint c = measured(std::min(i, j), std::max(i, j), truth);
      c.from_to = c.from_to * (k % 10 < 3 ? random.pose(5, 0.5) : random.pose(0.01, 0.002));
      c.information = information(0.01, 0.002);
      c.loop_closure = true;
      graph.connect(c);
      if (k % 10 >= 3) without_wrong.connect(c);
    }
    CHECK(worst(graph, truth) > 1.0);
    graph.optimise();
    without_wrong.optimise();
    for (const auto& [node, pose] : without_wrong.nodes())
      CHECK(se3_log(pose.inverse() * graph.nodes().at(node)).norm() < 0.02);
    int believed = 0;
    for (const Constraint& c : graph.constraints()) believed += c.loop_closure && graph.weight(c) > 0.3;
    CHECK(believed >= 38);
    CHECK(believed <= 42);
  }
}

TEST_CASE("a covariance is that of the chained constraints, and an equal loop closure halves it") {
  Random random(4);
  const std::vector<Pose> truth = ring(30);
  PoseGraph graph;
  Constraint all;
  for (std::uint32_t i = 0; i < 30; ++i) {
    graph.add(i, truth[i]);
    if (i == 0) continue;
    Constraint c = measured(i - 1, i, truth);
    c.information = 1e4 * random.information();
    all = i == 1 ? c : chained(all, c);
    graph.connect(c);
  }
  const Matrix6 open = graph.covariance(0, 29);
  CHECK((open * all.information - Matrix6::Identity()).norm() < 1e-4);
  Constraint closure = measured(0, 29, truth);
  closure.information = all.information;
  closure.loop_closure = true;
  graph.connect(closure);
  CHECK((2 * graph.covariance(0, 29) - open).norm() < 1e-4 * open.norm());
  // In the other direction: the same covariance, in the frame of the other node.
  const Matrix6 back = adjoint(truth[29].inverse() * truth[0]);
  CHECK((back * graph.covariance(29, 0) * back.transpose() - graph.covariance(0, 29)).norm() <
        1e-4 * open.norm());
  // Several at once: the same as each by itself.
  const std::vector<RelativePose> many = graph.relative({{0, 29}, {12, 17}, {21, 20}});
  for (const auto& [k, from, to] : {std::tuple{1U, 12U, 17U}, {2U, 21U, 20U}}) {
    const Matrix6 alone = graph.covariance(from, to);
    CHECK((many[k].covariance - alone).norm() < 1e-6 * alone.norm());
    CHECK((many[k].from_to.matrix() - (truth[from].inverse() * truth[to]).matrix()).norm() < 1e-12);
  }
  graph.add(77, Pose::Identity());
  CHECK(graph.covariance(0, 77).diagonal().minCoeff() > 1e6);
}

TEST_CASE("removing a node keeps the constraints measured through it, and drops its loop closures") {
  Random random(5);
  std::vector<Pose> truth = ring(12);
  PoseGraph graph = chain(truth, random);
  const Matrix6 before = graph.covariance(0, 11);
  for (const std::uint32_t node : {5u, 3u, 4u}) graph.remove(node);
  CHECK(graph.nodes().size() == 9);
  CHECK(graph.constraints().size() == 8);
  CHECK((graph.covariance(0, 11) - before).norm() < 1e-6 * before.norm());
  Constraint wrong = measured(6, 9, truth);
  wrong.from_to = wrong.from_to * random.pose(3, 0.1);
  wrong.information = information(0.01, 0.01);
  wrong.loop_closure = true;
  graph.connect(wrong);
  graph.remove(9);
  CHECK(std::none_of(graph.constraints().begin(), graph.constraints().end(),
                     [](const Constraint& c) { return c.loop_closure; }));
  graph.remove(0);
  graph.optimise();
  CHECK(worst(graph, truth) < 1e-9);
}

TEST_CASE(
    "replacing a node connects its neighbours to the node that stays, and lowers no covariance of revisits") {
  Random random(6);
  const std::vector<Pose> truth = ring(12);
  PoseGraph graph = chain(truth, random);
  graph.optimise();
  const Matrix6 before = graph.covariance(3, 8);
  // Node 9 is a revisit of the place of node 3.
  Constraint closure = measured(3, 9, truth);
  closure.loop_closure = true;
  graph.connect(closure);
  const auto between = [&](std::uint32_t from, std::uint32_t to) {
    for (const Constraint& c : graph.constraints())
      if (c.from == from && c.to == to) return c;
    return Constraint();
  };
  const Constraint through = chained(closure, reversed(between(8, 9)));
  graph.replace(9, closure);
  CHECK(graph.nodes().size() == 11);
  CHECK(graph.constraints().size() == 11);                 // 0 to 8, and 3 to 8 and 10
  CHECK(graph.covariance(3, 8).trace() < before.trace());  // two paths lead there
  CHECK((between(3, 8).information - through.information).norm() < 1e-6 * through.information.norm());
  CHECK(graph.optimise().metres < 1e-9);
  // Repeated visits: the covariance between 3 and 4 does not change, however many there are.
  const Matrix6 known = graph.covariance(3, 4);
  for (std::uint32_t lap = 20; lap < 40; lap += 2) {
    graph.add(lap, random.pose(0.01, 0.001) * truth[3]);
    graph.add(lap + 1, random.pose(0.01, 0.001) * truth[4]);
    Constraint step = measured(3, 4, truth);
    step.from = lap;
    step.to = lap + 1;
    graph.connect(step);
    Constraint first = closure, second = closure;
    first.from_to = second.from_to = Pose::Identity();
    first.from = 3;
    first.to = lap;
    second.from = 4;
    second.to = lap + 1;
    graph.connect(first);
    graph.connect(second);
    graph.replace(lap, reversed(first));
    graph.replace(lap + 1, second);
  }
  CHECK(graph.constraints().size() == 11);
  CHECK((graph.covariance(3, 4) - known).norm() == 0);
  CHECK(graph.optimise().metres < 1e-9);
}

TEST_CASE("nodes that were optimised elsewhere move the later nodes with them") {
  const std::vector<Pose> truth = ring(6);
  PoseGraph graph;
  for (std::uint32_t i = 0; i < 6; ++i) graph.add(i, truth[i]);
  Random random(7);
  const Pose by = random.pose(1, 0.1);
  graph.move({{1, truth[0]}, {3, by * truth[3]}});
  CHECK(graph.nodes().at(1).matrix() == truth[0].matrix());
  CHECK(graph.nodes().size() == 6);
  CHECK(graph.nodes().at(2).matrix() == truth[2].matrix());
  CHECK(graph.nodes().at(3).matrix() == (by * truth[3]).matrix());
  CHECK((graph.nodes().at(5).matrix() - (by * truth[5]).matrix()).norm() < 1e-9);
}

TEST_CASE("two measurements of one relative pose count as their weighted mean") {
  std::vector<Pose> truth(2, Pose::Identity());
  PoseGraph graph;
  graph.add(0, truth[0]);
  graph.add(1, truth[1]);
  Constraint c = measured(0, 1, truth);
  graph.connect(c);
  c.from_to.translation().x() = 0.4;
  c.information *= 3;
  graph.connect(reversed(c));
  REQUIRE(graph.constraints().size() == 1);
  graph.optimise();
  CHECK(graph.nodes().at(1).translation().x() == doctest::Approx(0.3));
  CHECK(graph.covariance(0, 1)(0, 0) == doctest::Approx(0.25).epsilon(1e-4));
}

}  // namespace scanlock
