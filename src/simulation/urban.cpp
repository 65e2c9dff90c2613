// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/elementary.hpp"
#include "simulation/changes.hpp"
#include "simulation/laps.hpp"
#include "simulation/random.hpp"
#include "simulation/urban_buildings.hpp"
#include "simulation/urban_streets.hpp"
#include "simulation/world.hpp"

namespace scanlock {
namespace {

constexpr double kPavement = 3.4;   // metres: from the kerb to the fronts of houses without a garden
constexpr double kLapLength = 600;  // metres

/// Rolling ground, slopes of up to about 3 %.
double ground_height(double x, double y, const std::array<double, 4>& phase) {
  return 1.2 * sin(x / 70 + phase[0]) + 1.0 * sin(y / 85 + phase[1]) + 0.5 * sin((x + y) / 45 + phase[2]) +
         0.03 * sin(x / 6 + phase[3]) * sin(y / 7);
}

/// Adds a slab that follows the slope of the ground and is higher than it by the height of a kerb.
void add_pavement(Scene& scene, const Polyline& middle, double s, double length) {
  const Eigen::Vector3d centre = on_ground(scene, middle.at(s));
  const double yaw = middle.heading(s);
  const Eigen::Vector2d ahead(cos(yaw), sin(yaw)), left(-ahead.y(), ahead.x());
  const auto slope = [&](const Eigen::Vector2d& along) {
    const Eigen::Vector2d p = centre.head<2>();
    const Eigen::Vector3d step = on_ground(scene, p + along) - on_ground(scene, p - along);
    return Eigen::Vector3d(step.normalized());
  };
  Box slab;
  slab.world_from_box.col(0) = slope(ahead);
  slab.world_from_box.col(2) = slab.world_from_box.col(0).cross(slope(left)).normalized();
  slab.world_from_box.col(1) = slab.world_from_box.col(2).cross(slab.world_from_box.col(0));
  slab.half = {length / 2 + 0.05, kPavement / 2, 0.2};
  slab.centre = centre + Eigen::Vector3d(0, 0, 0.13 - 0.2);
  slab.reflectivity = 0.3;
  scene.add(slab);
}

void add_parked_car(Scene& scene, const Eigen::Vector3d& place, double yaw, Random& random) {
  const double paint = random.uniform(0.1, 0.8);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  if (random.chance(0.12)) {  // a van
    scene.add(Box::upright(place + 0.3 * up, yaw, {5.2, 1.95, random.uniform(1.7, 2.1)}, paint));
    return;
  }
  const double length = random.uniform(3.7, 4.8);
  const Eigen::Vector3d back = random.uniform(0.1, 0.6) * Eigen::Vector3d(-cos(yaw), -sin(yaw), 0);
  scene.add(Box::upright(place + 0.22 * up, yaw, {length, 1.78, 0.65}, paint));
  scene.add(
      Box::upright(place + back + 0.87 * up, yaw, {0.52 * length, 1.5, random.uniform(0.5, 0.7)}, 0.15));
}

void add_tree(Scene& scene, const Eigen::Vector3d& place, Random& random) {
  Cylinder trunk;
  trunk.base = place;
  trunk.length = random.uniform(3.5, 5);
  trunk.radius = random.uniform(0.1, 0.24);
  scene.add(trunk);
  const double wide = random.uniform(1.5, 2.6), high = random.uniform(1.4, 2.4);
  scene.add(Ellipsoid{place + Eigen::Vector3d(0, 0, 2.6 + high), {wide, wide, high}, 0.9, 0.3});
}

/// Adds pavement, parked cars, trees, lamps and houses along one side of a street.
void furnish_side(Scene& scene, const StreetPlan& plan, std::size_t street, bool left, Random& random,
                  Changes& changes) {
  const double side = left ? 1 : -1;
  const Polyline& axis = plan.streets[street];
  const Polyline parking = axis.offset(side * 4.7), kerb = axis.offset(side * 6.3);
  const Polyline pavement = axis.offset(side * (kKerb + kPavement / 2));
  const auto clear = [&](const Eigen::Vector2d& p, double margin) {
    return plan.clear_of_others(street, p, kCorridor + margin);
  };
  constexpr double kSlab = 4;
  for (double s = kSlab / 2; s < pavement.length(); s += kSlab)
    if (plan.clear_of_others(street, pavement.at(s), kKerb + kSlab / 2))
      add_pavement(scene, pavement, s, kSlab);
  Scene elsewhere;  // receives cars that have been moved away, and is discarded
  for (double s = 5; s < parking.length(); s += random.uniform(5.6, 7.5)) {
    const bool parked = random.chance(0.6) && clear(parking.at(s), 3), changed = changes.next();
    const auto park = [&](double at, Scene& where, Random& dice) {
      add_parked_car(where, on_ground(scene, parking.at(at)), parking.heading(at) + dice.uniform(-0.04, 0.04),
                     dice);
    };
    if (parked) park(s, changed ? elsewhere : scene, random);
    if (changed && clear(parking.at(s), 5) && changes.random().chance(0.6))
      park(s + changes.random().uniform(-1, 1), scene, changes.random());
  }
  for (double s = random.uniform(3, 12); s < kerb.length(); s += random.uniform(8, 18)) {
    Eigen::Vector3d place = on_ground(scene, kerb.at(s));
    if (!clear(kerb.at(s), 0)) continue;
    if (random.chance(0.55)) {
      add_tree(scene, place, random);
    } else if (random.chance(0.6)) {
      scene.add(
          Cylinder{place, Eigen::Vector3d::UnitZ(), random.uniform(3, 8), random.uniform(0.05, 0.1), 0.5});
    } else {  // a bin or a cabinet
      if (changes.next()) place = on_ground(scene, kerb.at(s + changes.random().uniform(-6, 6)));
      scene.add(Box::upright(place, kerb.heading(s),
                             {random.uniform(0.4, 1.4), 0.5, random.uniform(0.9, 1.5)}, 0.5));
    }
  }
  add_buildings(scene, plan, street, side, random);
}

/// Cars in both lanes of every street, people on the pavements, one car in front of the carrier and one
/// behind it.
std::vector<Mover> make_traffic(const StreetPlan& plan, const Polyline& route, Random& random) {
  std::vector<Mover> movers;
  for (const Polyline& axis : plan.streets)
    for (const bool back : {false, true}) {
      const Polyline lane = (back ? axis.reversed() : axis).offset(-kLane).resampled(2);
      const double speed = random.uniform(6, 12);  // one speed per lane, so that cars do not collide
      for (double s = random.uniform(0, 60); s < lane.length() - 20; s += random.uniform(25, 120))
        movers.push_back(make_car(lane, s, speed, random.uniform(0.1, 0.8)));
      const Polyline walk =
          (back ? axis.reversed() : axis).offset(-(kKerb + random.uniform(0.8, 2.4))).resampled(2);
      for (double s = random.uniform(0, 40); s < walk.length(); s += random.uniform(10, 60))
        movers.push_back(make_person(walk, s, random.uniform(0.8, 1.7)));
    }
  for (const double gap : {random.uniform(14, 20), random.uniform(-18, -12)}) {
    movers.push_back(make_car(route, gap, 0, 0.5));
    movers.back().in_convoy = true;
  }
  return movers;
}

}  // namespace

World make_urban(std::uint64_t seed, const Visit& visit, const DriveStyle& style) {
  Random random(seed, 10);
  Changes changes(seed, visit);
  const StreetPlan plan = plan_streets(random);
  const std::array<double, 4> phase = {random.uniform(0, 6), random.uniform(0, 6), random.uniform(0, 6),
                                       random.uniform(0, 6)};
  World world;
  world.style = style;
  world.scene =
      Scene(Terrain(plan.low, plan.high, 3, [&](double x, double y) { return ground_height(x, y, phase); }));
  for (std::size_t street = 0; street < plan.streets.size(); ++street)
    for (const bool left : {false, true}) furnish_side(world.scene, plan, street, left, random, changes);
  world.scene.build();
  if (visit.seed) random = Random(*visit.seed, 10);
  constexpr Wander kWander{0.3, 40};
  if (visit.laps > 0)
    set_laps(world, plan_loop(plan, kLapLength, random), visit.laps, kWander, random);
  else
    world.route = plan_route(plan, needed_length(style, visit.seconds), random);
  world.movers = make_traffic(plan, world.route, random);
  return world;
}

}  // namespace scanlock
