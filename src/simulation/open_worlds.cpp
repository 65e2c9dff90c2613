// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The worlds without streets: forest, field and tunnel.
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "simulation/laps.hpp"
#include "simulation/random.hpp"
#include "simulation/world.hpp"

namespace scanlock {
namespace {

/// A wavy path around the origin.
class Round {
 public:
  /// `third`: periods of the third wave per turn; with a fractional number, each turn takes a different line.
  Round(double radius, double third, Random& random)
      : radius_(radius),
        third_(third),
        a_(random.uniform(0, 2 * kPi)),
        b_(random.uniform(0, 2 * kPi)),
        c_(random.uniform(0, 2 * kPi)),
        direction_(random.chance(0.5) ? 1 : -1) {}

  Eigen::Vector2d at(double angle) const {
    const double r = radius_ * (1 + 0.22 * sin(3 * angle + a_) + 0.1 * sin(5 * angle + b_) +
                                0.03 * sin(third_ * angle + c_));
    return r * Eigen::Vector2d(cos(angle), direction_ * sin(angle));
  }
  double step() const { return 0.2 / radius_; }  ///< radians; about 0.2 m along the path

 private:
  double radius_, third_, a_, b_, c_, direction_;
};

/// A path of `length` metres around the origin, of as many turns as needed, no two of them on the same line.
Polyline plan_round(double radius, double length, Random& random) {
  const Round round(radius, 9.3, random);
  std::vector<Eigen::Vector2d> points;
  double driven = 0;
  for (double angle = 0; driven < length; angle += round.step()) {
    points.push_back(round.at(angle));
    if (points.size() > 1) driven += (points.back() - points[points.size() - 2]).norm();
  }
  return Polyline(points).smoothed(0.2, 2);
}

/// One turn; its last point equals its first.
Polyline plan_lap(double radius, Random& random) {
  const Round round(radius, 9, random);
  std::vector<Eigen::Vector2d> points;
  for (double angle = 0; angle < 2 * kPi - round.step() / 2; angle += round.step())
    points.push_back(round.at(angle));
  return closed_lap(points, 0.2, 2);
}

double distance_to(const Polyline& route, const Eigen::Vector2d& p) {
  double nearest = HUGE_VAL;
  for (std::size_t i = 0; i < route.points().size(); i += 3)
    nearest = std::min(nearest, (route.points()[i] - p).squaredNorm());
  return std::sqrt(nearest);
}

/// Smooth hills: sinusoids of decreasing wavelength and height.
class Hills {
 public:
  Hills(double longest, double highest, double shortest, Random& random) {
    for (double length = longest, height = highest; length > shortest; length *= 0.6, height *= 0.55) {
      const double angle = random.uniform(0, 2 * kPi);
      waves_.push_back(
          {2 * kPi / length * Eigen::Vector2d(cos(angle), sin(angle)), random.uniform(0, 2 * kPi), height});
    }
  }
  double operator()(double x, double y) const {
    double sum = 0;
    for (const Wave& wave : waves_)
      sum += wave.height * sin(wave.number.dot(Eigen::Vector2d(x, y)) + wave.phase);
    return sum;
  }

 private:
  struct Wave {
    Eigen::Vector2d number;
    double phase, height;
  };
  std::vector<Wave> waves_;
};

void add_forest_tree(Scene& scene, const Eigen::Vector3d& place, Random& random) {
  const double lean = random.uniform(0, 0.09), to = random.uniform(0, 2 * kPi);
  Cylinder trunk;
  trunk.axis = Eigen::Vector3d(lean * cos(to), lean * sin(to), 1).normalized();
  trunk.base = place - 0.3 * trunk.axis;
  trunk.length = random.uniform(9, 18);
  trunk.radius = random.uniform(0.07, 0.32);
  scene.add(trunk);
  const double wide = random.uniform(1.2, 2.8), high = random.uniform(2, 4);
  scene.add(
      Ellipsoid{trunk.base + trunk.length * trunk.axis, {wide, wide, high}, random.uniform(0.3, 0.9), 0.3});
}

}  // namespace

World make_forest(std::uint64_t seed, const Visit& visit, const DriveStyle& style) {
  Random random(seed, 30);
  constexpr double kRadius = 45, kReach = 130, kTreesPerSquareMetre = 0.045;
  constexpr Wander kWander{0.35, 8};
  const double aside = visit.laps > 0 ? 2 * kWander.aside_m : 0;  // deviation between two laps
  World world;
  world.style = style;
  if (visit.laps > 0)
    set_laps(world, plan_lap(kRadius, random), visit.laps, kWander, random);
  else
    world.route = plan_round(kRadius, needed_length(style, visit.seconds), random);
  const Hills hills(60, 1.6, 2.5, random);
  world.scene = Scene(Terrain({-kReach, -kReach}, {kReach, kReach}, 1, hills));
  const Polyline round(std::vector<Eigen::Vector2d>(  // one turn is enough to keep trees away from
      world.route.points().begin(),
      world.route.points().begin() +
          static_cast<std::ptrdiff_t>(std::min<std::size_t>(world.route.points().size(), 3000))));
  const int trees = static_cast<int>(4 * kReach * kReach * kTreesPerSquareMetre);
  for (int i = 0; i < trees; ++i) {
    const double y = random.uniform(-kReach, kReach), x = random.uniform(-kReach, kReach);
    const Eigen::Vector2d p(x, y);
    const bool bush = random.chance(0.2);
    if (distance_to(round, p) < (bush ? 1.8 : 1.0) + aside) continue;
    const Eigen::Vector3d place = on_ground(world.scene, p);
    if (!bush) {
      add_forest_tree(world.scene, place, random);
      continue;
    }
    const double wide = random.uniform(0.4, 1.2), high = random.uniform(0.4, 1.1);
    world.scene.add(Ellipsoid{place, {wide, wide, high}, random.uniform(2, 6), 0.3});
  }
  world.scene.build();
  return world;
}

World make_field(std::uint64_t seed, const Visit& visit, const DriveStyle& style) {
  Random random(seed, 40);
  constexpr double kRadius = 60, kReach = 190;
  constexpr Wander kWander{0.8, 25};
  World world;
  world.style = style;
  if (visit.laps > 0)
    set_laps(world, plan_lap(kRadius, random), visit.laps, kWander, random);
  else
    world.route = plan_round(kRadius, needed_length(style, visit.seconds), random);
  const Hills hills(150, 2.0, 6, random);
  world.scene = Scene(Terrain({-kReach, -kReach}, {kReach, kReach}, 2, hills));
  for (int i = 0; i < 14; ++i) {  // distant bushes, hay bales and poles, and one barn
    const double angle = random.uniform(0, 2 * kPi), radius = random.uniform(95, 150);
    const Eigen::Vector3d place = on_ground(world.scene, radius * Eigen::Vector2d(cos(angle), sin(angle)));
    const double yaw = random.uniform(0, kPi);
    if (i == 0) {
      world.scene.add(Box::upright(place - Eigen::Vector3d(0, 0, 2), yaw, {18, 9, 8}, 0.5));
    } else if (i < 5) {
      world.scene.add(Ellipsoid{place, {3, 3, 4}, 1.0, 0.3});
    } else if (i < 10) {
      world.scene.add(Cylinder{place + Eigen::Vector3d(0, 0, 0.6), {cos(yaw), sin(yaw), 0}, 1.3, 0.65, 0.5});
    } else {
      world.scene.add(Cylinder{place, Eigen::Vector3d::UnitZ(), 8, 0.12, 0.5});
    }
  }
  world.scene.build();
  return world;
}

World make_tunnel(std::uint64_t seed, const Visit& visit, const DriveStyle& style) {
  Random random(seed, 50);
  constexpr double kPortal = 40, kSegment = 4, kHalfWidth = 5, kSides = 14;
  World world;
  world.style = style;
  const double length = needed_length(style, visit.seconds) + kPortal;
  std::vector<Eigen::Vector2d> points = {{0, 0}};
  double heading = 0, bend = 0;
  for (double s = 0; s < length + 100; s += 5) {
    if (std::fmod(s, 150) < 5) bend = s < kPortal || random.chance(0.5) ? 0 : random.uniform(-1, 1) / 300;
    heading = std::clamp(heading + 5 * bend, -1.0, 1.0);  // the tunnel may wind, but does not cross itself
    points.push_back(points.back() + 5 * Eigen::Vector2d(cos(heading), sin(heading)));
  }
  const Polyline axis = Polyline(points).smoothed(1, 30);
  world.route = axis.offset(-1.75).resampled(0.5);

  Eigen::Vector2d low = axis.points().front(), high = low;
  for (const Eigen::Vector2d& p : axis.points()) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector2d margin(60, 60);
  const double period = random.uniform(200, 400);
  world.scene = Scene(Terrain(low - margin, high + margin, 4,
                              [&](double x, double) { return 3 * sin(2 * kPi * x / period / 3); }));
  // The vault consists of slabs along a regular polygon, whose lowest part the road cuts off.
  for (double s = kPortal; s < axis.length(); s += kSegment) {
    const Eigen::Vector2d p = axis.at(s), q = axis.at(s + kSegment);
    const Eigen::Vector3d from = on_ground(world.scene, p), to = on_ground(world.scene, q);
    if ((to - from).norm() < 0.5) break;
    const Eigen::Vector3d along = (to - from).normalized();
    const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(along).normalized(), up = along.cross(left);
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * kPi * (side + 0.5) / kSides;
      const Eigen::Vector3d out = cos(angle) * left + sin(angle) * up;
      const Eigen::Vector3d centre = (from + to) / 2 + 1.5 * up;
      if (sin(angle) < -0.5) continue;
      Box slab;
      slab.world_from_box.col(0) = along;
      slab.world_from_box.col(2) = out;
      slab.world_from_box.col(1) = out.cross(along);
      slab.half = {(to - from).norm() / 2 + 0.03, (kHalfWidth + 0.2) * sin(kPi / kSides) / cos(kPi / kSides),
                   0.1};
      slab.centre = centre + (kHalfWidth + 0.1) * out;
      slab.reflectivity = 0.4;
      world.scene.add(slab);
    }
  }
  // The portal, and objects in front of it.
  const Eigen::Vector3d portal = on_ground(world.scene, axis.at(kPortal));
  for (const double side : {-1.0, 1.0}) {
    world.scene.add(
        Box::upright(portal + Eigen::Vector3d(0.5, side * (kHalfWidth + 4), -2), 0, {1, 8, 12}, 0.6));
    for (int i = 0; i < 6; ++i) {
      const double y = side * random.uniform(7, 25), x = random.uniform(-40, kPortal - 4);
      const Eigen::Vector3d bottom = on_ground(world.scene, {x, y}) - Eigen::Vector3d(0, 0, 1);
      const Eigen::Vector3d size{random.uniform(2, 9), random.uniform(2, 6), random.uniform(2, 7)};
      world.scene.add(Box::upright(bottom, random.uniform(0, kPi), size, 0.5));
    }
  }
  world.scene.build();
  return world;
}

}  // namespace scanlock
