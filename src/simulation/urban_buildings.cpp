// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/urban_buildings.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

/// Frame of a house: origin at the centre of its front on the ground, x along the front, y away from the
/// street.
struct Lot {
  Eigen::Vector3d origin;
  double yaw;
  double width, depth, height;
  double reflectivity;

  Eigen::Vector3d world(double x, double y, double z) const {
    return origin + Eigen::Vector3d(cos(yaw) * x - sin(yaw) * y, sin(yaw) * x + cos(yaw) * y, z);
  }
  /// A box from y0 to y1, centred at x, with its bottom at z.
  Box box(double x, double y0, double y1, double z, double wide, double high) const {
    return Box::upright(world(x, (y0 + y1) / 2, z), yaw, {wide, y1 - y0, high}, reflectivity);
  }
};

/// Adds a house. Pillars and bands protrude from the wall of its front, so that windows are recesses; some
/// houses have balconies.
void add_house(Scene& scene, const Lot& lot, Random& random) {
  constexpr double kSink = 1.5;  // depth of the foundations, since the ground slopes
  const double recess = random.uniform(0.12, 0.35);
  scene.add(lot.box(0, recess, lot.depth, -kSink, lot.width, lot.height + kSink));

  const int bays = std::max(2, static_cast<int>(std::lround(lot.width / random.uniform(2.4, 4))));
  const double bay = lot.width / bays, pillar = random.uniform(0.35, 0.55) * bay;
  for (int i = 0; i <= bays; ++i) {
    const bool corner = i == 0 || i == bays;
    const double wide = corner ? pillar / 2 : pillar;
    const double x = -lot.width / 2 + i * bay + (i == 0 ? wide / 2 : i == bays ? -wide / 2 : 0);
    scene.add(lot.box(x, 0, recess, -kSink, wide, lot.height + kSink));
  }
  const double storey = random.uniform(2.8, 3.5);
  scene.add(lot.box(0, -0.05, recess, -kSink, lot.width, kSink + random.uniform(0.4, 0.9)));
  const bool balconies = random.chance(0.35);
  for (double z = storey; z < lot.height - 0.5; z += storey) {
    const double band = random.uniform(0.7, 1.2);
    scene.add(lot.box(0, 0, recess, z - band / 2, lot.width, band));
    for (int i = 0; balconies && i < bays; ++i)
      if (random.chance(0.4))
        scene.add(lot.box(-lot.width / 2 + (i + 0.5) * bay, -1.1, 0.05, z - 0.1, 0.8 * bay, 1.1));
  }
  if (random.chance(0.3)) {  // a porch
    const double width = random.uniform(1.5, 2.6), depth = random.uniform(0.6, 1.4);
    const double middle = random.uniform(-0.3, 0.3) * lot.width;
    scene.add(lot.box(middle, -depth, recess, -kSink, width, kSink + 2.6));
  }
}

bool is_clear(const StreetPlan& plan, std::size_t street, const Lot& lot) {
  for (const double x : {-0.5, -0.25, 0.0, 0.25, 0.5})
    for (const double y : {0.0, 0.5, 1.0}) {
      const Eigen::Vector3d p = lot.world(x * lot.width, y * lot.depth, 0);
      if (!plan.clear_of_others(street, p.head<2>(), kCorridor)) return false;
    }
  return true;
}

}  // namespace

void add_buildings(Scene& scene, const StreetPlan& plan, std::size_t street, double side, Random& random) {
  const Polyline front = plan.streets[street].offset(side * kCorridor);
  double s = random.uniform(0, 4);
  while (s < front.length() - 6) {
    Lot lot;
    lot.width = random.uniform(8, 24);
    lot.depth = random.uniform(8, 13);
    lot.height = random.uniform(5, 21);
    lot.reflectivity = random.uniform(0.25, 0.7);
    const double setback = random.chance(0.5) ? random.uniform(0, 0.4) : random.uniform(0.5, 4.5);
    const double middle = s + lot.width / 2;
    lot.yaw = front.heading(middle) + (side > 0 ? 0 : 3.14159265358979);
    const Eigen::Vector2d place = front.at(middle);
    lot.origin = {place.x(), place.y(), scene.terrain().height(place.x(), place.y())};
    lot.origin = lot.world(0, setback, 0);
    if (!is_clear(plan, street, lot)) {
      s += 2;
      continue;
    }
    add_house(scene, lot, random);
    s += lot.width;
    if (random.chance(0.45)) {
      const double gap = random.uniform(1.5, 9);
      Lot fence = lot;
      fence.origin = lot.world((side > 0 ? 1 : -1) * (lot.width + gap) / 2, 0, 0);
      fence.width = gap;
      fence.depth = 0.3;
      if (random.chance(0.6) && is_clear(plan, street, fence)) {
        const double height = random.uniform(0.8, 1.9), thickness = random.uniform(0.15, 0.6);
        scene.add(fence.box(0, 0, thickness, -1, gap, 1 + height));
      }
      s += gap;
    }
  }
}

}  // namespace scanlock
