// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the solver against the printed algorithms of the paper (test/reference), on clouds of some dozens
// of points.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "../reference/robust_plane_icp.hpp"
#include "../reference/robust_point_icp.hpp"
#include "../trials.hpp"
#include "cloud_samples.hpp"
#include "icp/cloud_alignment.hpp"

using namespace scanlock;
using namespace scanlock::test;

namespace {

reference::Points points_of(const PointCloud& cloud) {
  reference::Points points(3, static_cast<Eigen::Index>(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = cloud.point(i).cast<double>();
  return points;
}

reference::Points normals_of(const PointCloud& cloud) {
  reference::Points normals(3, static_cast<Eigen::Index>(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    normals.col(static_cast<Eigen::Index>(i)) = cloud.normal(i).cast<double>();
  return normals;
}

/// A noisy part of a room in another frame with some clutter, and the room, relative to their centres; in
/// floats and in doubles.
struct SmallCase {
  CentredCloud source;
  CloudTarget target;
  Pose start;  // between the centred frames, as are all poses here
  reference::Points p, q, n;

  static PointCloud part_of(const PointCloud& room, Random& random) {
    PointCloud part;
    for (std::size_t i = 0; i < room.size(); i += 2)
      part.push_back(room.point(i) + Eigen::Vector3f((0.01 * random.vector()).cast<float>()));
    for (int i = 0; i < 6; ++i) part.push_back(Eigen::Vector3f((2.0 * random.vector()).cast<float>()));
    return part;
  }
  SmallCase(const PointCloud& room, Random& random) : source(centred(part_of(room, random))), target(room) {
    target.prepare_normals();
    start = motion(source.centre - target.centre() + 0.1 * random.vector(), 0.04 * random.vector());
    p = points_of(source.points);
    q = points_of(target.points());
    n = normals_of(target.points());
  }

  /// The solver on the input of the reference: every pair, the same nu, down to rounding.
  DescentResult solve(IcpObjective objective, const reference::RobustIcpOptions& options, Pose* pose) const {
    CloudProblem problem(source.points, target, {objective, MotionCoordinates::kLieAlgebra, true, 1});
    const double gate = open_gate(source, target, start);
    const auto begin = [&](const StateVector& x, double nu, bool) {
      DescentOptions descent;
      descent.max_iterations = options.most_iterations;
      descent.max_line_search_steps = objective == IcpObjective::kPoint ? 0 : 20;
      descent.tolerance = 1e-9;
      return NuLevel{nu == options.nu_max ? x : problem.begin(problem.pose(), nu, gate), descent};
    };
    const DescentResult found = robust_icp(problem, problem.begin(start, options.nu_max, gate),
                                           options.nu_max, options.nu_min, begin);
    *pose = problem.pose();
    return found;
  }
};

reference::RobustIcpOptions small_options() {
  reference::RobustIcpOptions options;
  options.nu_max = 0.6;
  options.nu_min = 0.03;
  options.epsilon = 1e-9;
  return options;
}

SmallCase small_case(unsigned seed) {
  Random random(seed);
  const PointCloud cloud = room(random, 70);
  return SmallCase(cloud, random);
}

// The solver's coordinates are floats: at 4 m they have errors of 2e-7 m, which change an energy of some 8 by
// about 1e-5. With 20 inliers at nu = 0.03 m its second derivative is 20 / nu^2, so its minimum moves by 3e-5
// m.
constexpr double kRounding = 1e-5, kMetres = 1e-4, kRadians = 4e-5;

void check_same(const Pose& found, const Pose& expected) {
  CHECK((found.translation() - expected.translation()).norm() < kMetres);
  CHECK(so3_log(found.linear().transpose() * expected.linear()).norm() < kRadians);
}

}  // namespace

TEST_CASE("robust point-to-point comes to the minimum of the printed algorithm 1") {
  for (int seed = 0; seed < trials(50); ++seed) {
    CAPTURE(seed);
    const SmallCase it = small_case(static_cast<unsigned>(seed));
    const reference::RobustIcpOptions options = small_options();
    const auto energy = [&](const Pose& pose) {
      const auto nearest = reference::correspondence(it.p, it.q, pose);
      return reference::energy(it.p, reference::selected(it.q, nearest), pose, options.nu_min);
    };
    const Pose expected = reference::robust_point_icp(it.p, it.q, it.start, options);
    Pose found;
    const DescentResult result = it.solve(IcpObjective::kPoint, options, &found);
    check_same(found, expected);
    CHECK(energy(found) == doctest::Approx(energy(expected)).epsilon(1e-6));
    CHECK(std::abs(result.energy - energy(expected)) < kRounding * result.energy);
    CHECK(result.converged);
  }
}

TEST_CASE("robust point-to-plane comes to the minimum of the printed algorithm 2") {
  for (int seed = 0; seed < trials(50); ++seed) {
    CAPTURE(seed);
    const SmallCase it = small_case(static_cast<unsigned>(seed));
    reference::RobustIcpOptions options = small_options();
    options.most_iterations = 200;
    const auto energy = [&](const Pose& pose) {
      return reference::plane_energy(it.p, it.q, it.n, se3_log(pose), options.nu_min);
    };
    const Pose expected = reference::robust_plane_icp(it.p, it.q, it.n, it.start, options);
    Pose found;
    const DescentResult result = it.solve(IcpObjective::kPlane, options, &found);
    check_same(found, expected);
    CHECK(energy(found) == doctest::Approx(energy(expected)).epsilon(1e-6));
    CHECK(std::abs(result.energy - energy(expected)) < kRounding * result.energy);
  }
}

TEST_CASE("the accelerated step is the printed one") {
  Random random(5);
  for (int m = 0; m <= AndersonAcceleration::kMaxWindow; ++m) {
    AndersonAcceleration anderson(m);
    std::vector<Vector6> g, f;
    for (int k = 0; k < 12; ++k) {
      const Vector6 x = Vector6::NullaryExpr([&] { return random.number(); });
      g.push_back(Vector6::NullaryExpr([&] { return random.number(); }));
      f.push_back(g.back() - x);
      const Vector6 next = anderson.next(x, g.back());
      CHECK((next - reference::accelerated(g, f, k, 0, m)).norm() < 1e-9 * next.norm());
    }
  }
}

TEST_CASE("one step of either objective is the printed alignment step") {
  for (int seed = 0; seed < trials(20); ++seed) {
    CAPTURE(seed);
    SmallCase it = small_case(100 + static_cast<unsigned>(seed));
    const double nu = 0.2, gate = open_gate(it.source, it.target, it.start);
    const auto step = [&](IcpObjective objective) {
      CloudProblem problem(it.source.points, it.target, {objective, MotionCoordinates::kLieAlgebra, true, 1});
      problem.evaluate(problem.begin(it.start, nu, gate));
      return problem.pose_of(problem.image());
    };
    const Pose point = reference::alignment(
        it.p, reference::selected(it.q, reference::correspondence(it.p, it.q, it.start)), it.start, nu);
    CHECK((step(IcpObjective::kPoint).matrix() - point.matrix()).norm() < 1e-5);
    // The solver takes its plane step about the current pose: it equals the printed step at T = 0 for moved
    // points.
    it.p = it.start * it.p;
    const Vector6 plane = reference::g_ppl(it.p, it.q, it.n, Vector6::Zero(), nu);
    const Pose expected = se3_exp(plane) * it.start;
    CHECK((step(IcpObjective::kPlane).matrix() - expected.matrix()).norm() < 1e-4 * plane.norm() + 1e-6);
  }
}

TEST_CASE("the graduation halves nu down to nu_min, which comes last") {
  const SmallCase it = small_case(7);
  CloudProblem problem(it.source.points, it.target, {});
  const double gate = open_gate(it.source, it.target, it.start);
  for (const double nu_max : {0.1, 0.11, 0.4, 0.75}) {
    std::vector<double> nus;
    int steps = 0;
    const DescentResult found =
        robust_icp(problem, problem.begin(it.start, nu_max, gate), nu_max, 0.1,
                   [&](const StateVector& x, double nu, bool last) {
                     nus.push_back(nu);
                     CHECK(last == (nu == 0.1));
                     DescentOptions descent;
                     descent.step_length = [&](double) { ++steps; };
                     return NuLevel{nu == nu_max ? x : problem.begin(problem.pose(), nu, gate), descent};
                   });
    const std::vector<double> expected = nu_max == 0.1    ? std::vector<double>{0.1}
                                         : nu_max == 0.11 ? std::vector<double>{0.11, 0.1}
                                         : nu_max == 0.4  ? std::vector<double>{0.4, 0.2, 0.1}
                                                          : std::vector<double>{0.75, 0.375, 0.1875, 0.1};
    CHECK(nus == expected);
    CHECK(found.iterations <= steps);
    CHECK(problem.evaluate(found.x) == found.energy);
  }
}
