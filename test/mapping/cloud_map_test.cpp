// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/cloud_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "geometry/moved_cloud.hpp"
#include "mapping/floor.hpp"
#include "mapping/solid_cloud.hpp"

namespace scanlock {
namespace {

/// Adds a rectangle of random points with a mean spacing of `spacing` metres.
void add_rectangle(const Eigen::Vector3f& corner, const Eigen::Vector3f& u, const Eigen::Vector3f& v,
                   float spacing, PointCloud* cloud) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto count = static_cast<std::size_t>(u.norm() * v.norm() / (spacing * spacing));
  for (std::size_t i = 0; i < count; ++i)
    cloud->push_back(corner + uniform(random) * u + uniform(random) * v);
}

SolidCloud solid_of(const PointCloud& cloud, float voxel) {
  SolidCloud solid(voxel);
  solid.add(cloud);
  solid.close();
  return solid;
}

/// Two rooms of 8 x 6 m beside each other, 2.5 m high, without a door: x from 0 to 8 and from 8 to 16. A
/// table stands in the first one.
PointCloud two_rooms(float spacing) {
  PointCloud cloud;
  const Eigen::Vector3f x(16, 0, 0), y(0, 6, 0), z(0, 0, 2.5F);
  add_rectangle({0, 0, 0}, x, y, spacing, &cloud);
  add_rectangle({0, 0, 2.5F}, x, y, spacing, &cloud);
  add_rectangle({0, 0, 0}, x, z, spacing, &cloud);
  add_rectangle({0, 6, 0}, x, z, spacing, &cloud);
  for (const float wall : {0.0F, 8.0F, 16.0F}) add_rectangle({wall, 0, 0}, y, z, spacing, &cloud);
  add_rectangle({3, 2, 0.75F}, {1, 0, 0}, {0, 1, 0}, spacing, &cloud);
  return cloud;
}

}  // namespace

TEST_CASE("rays end at the first surface at any spacing of its points, and pass where there is no surface") {
  for (const float spacing : {0.05F, 0.1F, 0.2F}) {
    CAPTURE(spacing);
    PointCloud cloud;
    add_rectangle({5, -5, -5}, {0, 10, 0}, {0, 0, 10}, spacing, &cloud);
    add_rectangle({7, -5, -5}, {0, 10, 0}, {0, 0, 10}, spacing, &cloud);
    const SolidCloud solid = solid_of(cloud, 0.1F);
    int rays = 0, first = 0;
    for (float y = -0.6F; y < 0.6F; y += 0.031F) {
      for (float z = -0.6F; z < 0.6F; z += 0.037F) {
        const Eigen::Vector3f way = Eigen::Vector3f(1, y, z).normalized();
        const auto hit = solid.hit({0.01F, 0.02F, 0.03F}, way, 50);
        ++rays;
        if (!hit) continue;
        const Eigen::Vector3f there = solid.point(*hit);
        if (there.x() < 6) ++first;
        CHECK(there.cross(way).norm() < 1.0F);  // near the ray
        CHECK_FALSE(solid.hit({0.01F, 0.02F, 0.03F}, -way, 50));
        CHECK_FALSE(solid.hit({0.01F, 0.02F, 0.03F}, way, 4));
      }
    }
    CHECK(first > 0.95 * rays);
  }
}

TEST_CASE("forgotten points stop no ray, and points ahead of them keep their positions to 0.1 mm") {
  PointCloud cloud;
  add_rectangle({-20, -5, -5}, {0, 10, 0}, {0, 0, 10}, 0.05F, &cloud);
  add_rectangle({20.0123F, -5, -5}, {0, 10, 0}, {0, 0, 10}, 0.05F, &cloud);
  SolidCloud solid = solid_of(cloud, 0.1F);
  const Eigen::Vector3f eye(0.01F, 0.02F, 0.03F), ahead = Eigen::Vector3f::UnitX();
  CHECK(solid.hit(eye, -ahead, 50));
  solid.forget_below(-10);
  CHECK_FALSE(solid.hit(eye, -ahead, 50));
  const auto hit = solid.hit(eye, ahead, 50);
  REQUIRE(hit);
  CHECK(std::abs(solid.point(*hit).x() - 20.0123F) < 1e-4F);
}

TEST_CASE("a ray hits the voxel that a search in small steps finds") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-6, 6);
  PointCloud cloud;
  for (int i = 0; i < 60; ++i) cloud.push_back(uniform(random), uniform(random), uniform(random));
  const SolidCloud solid = solid_of(cloud, 0.5F);  // few points: they occlude their own voxels only
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f eye(uniform(random), uniform(random), uniform(random));
    const Eigen::Vector3f way =
        Eigen::Vector3f(uniform(random), uniform(random), uniform(random)).normalized();
    const auto hit = solid.hit(eye, way, 20);
    std::optional<float> first;  // metres to the first solid voxel outside that of the eye, by small steps
    for (float t = 0; t < 20 && !first; t += 0.002F) {
      const Eigen::Vector3f at = eye + t * way;
      const bool same = ((at / 0.5F).array().floor() == (eye / 0.5F).array().floor()).all();
      if (!same && solid.is_solid(at)) first = t;
    }
    if (hit) ++hits;
    // The steps can miss corners that the ray cuts by less than a step.
    if (first) REQUIRE(hit);
    if (!hit || !first) continue;
    const Eigen::Vector3f inside = eye + (*first + 0.001F) * way;
    CHECK((solid.point(*hit) - inside).cwiseAbs().maxCoeff() <= 0.55F);
  }
  CHECK(hits > 50);
}

TEST_CASE("keyframes of a bare cloud are inside its rooms and show hardly any points of the next room") {
  for (const double heading : {0.0, 0.4}) {
    Vector6 xi;
    xi << 100, -50, 3, 0, 0, heading;
    const Pose frame = se3_exp(xi);
    const SavedMap map = map_of_cloud(moved(two_rooms(0.05F), frame), "rooms", {});
    REQUIRE(map.keyframes.size() >= 2);
    CHECK(map.keyframes.size() < 200);
    int left = 0, right = 0;
    for (const ArchivedKeyframe& k : map.keyframes) {
      const Pose room_from_eye = frame.inverse() * k.map_from_body;
      const Eigen::Vector3d eye = room_from_eye.translation();
      CHECK(eye.x() > 0);
      CHECK(eye.x() < 16);
      CHECK(eye.y() > 0);
      CHECK(eye.y() < 6);
      CHECK(eye.z() > 0.5);  // not below the floor, and not above the ceiling
      CHECK(eye.z() < 2.5);
      ++(eye.x() < 8 ? left : right);
      std::size_t through = 0;
      const PointCloud points = *k.points.cloud();
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double x = (room_from_eye * points.point(i).cast<double>()).x();
        if (eye.x() < 8 ? x > 8.3 : x < 7.7) ++through;
      }
      CHECK(static_cast<double>(through) < 0.05 * static_cast<double>(points.size()));
      CHECK(k.reach > 0.5F);
      CHECK(k.reach < 8);
    }
    CHECK(left > 0);
    CHECK(right > 0);
    CHECK(map.constraints.size() == map.keyframes.size());
  }
}

TEST_CASE("people scanned across a corridor do not interrupt the keyframes along it") {
  PointCloud cloud;
  const Eigen::Vector3f x(60, 0, 0), y(0, 2.4F, 0), z(0, 0, 3);
  add_rectangle({0, 0, 0}, x, y, 0.05F, &cloud);
  add_rectangle({-5, -5, 3}, {70, 0, 0}, {0, 12, 0}, 0.1F, &cloud);  // the ceiling, also of the rooms around
  for (const float wall : {0.0F, 2.4F}) add_rectangle({0, wall, 0}, x, z, 0.05F, &cloud);
  for (const float end : {0.0F, 60.0F}) add_rectangle({end, 0, 0}, y, z, 0.05F, &cloud);
  for (float at = 2; at < 60; at += 2)
    for (const float side : {0.0F, 0.3F}) add_rectangle({at + side, 0, 0}, y, {0, 0, 1.8F}, 0.05F, &cloud);
  const SavedMap map = map_of_cloud(cloud, "corridor", {});
  std::vector<bool> shown(6, false);  // for each ten metres
  for (const ArchivedKeyframe& k : map.keyframes) {
    const Eigen::Vector3d eye = k.map_from_body.translation();
    if (eye.z() < 2 && eye.x() > 0 && eye.x() < 60) shown[static_cast<std::size_t>(eye.x() / 10)] = true;
  }
  CHECK(std::count(shown.begin(), shown.end(), true) == 6);
}

TEST_CASE("the upper side of a yard is the rougher one, and a yard that is upside down gives a warning") {
  PointCloud cloud;
  add_rectangle({0, 0, 0}, {20, 0, 0}, {0, 20, 0}, 0.05F, &cloud);
  for (const float x : {2.0F, 8.0F, 14.0F})  // carports
    for (const float y : {3.0F, 12.0F}) add_rectangle({x, y, 2.2F}, {5, 0, 0}, {0, 5, 0}, 0.05F, &cloud);
  Eigen::Matrix3d over;  // about x
  over << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const PointCloud turned = moved(cloud, Pose(over));
  const Floors upright = find_floors(solid_of(cloud, 0.1F));
  const Floors upside_down = find_floors(solid_of(turned, 0.1F));
  CHECK(upright.open);
  CHECK(upside_down.open);
  CHECK(upright.rough_below == 0);
  CHECK(upright.rough_above > 30);
  CHECK(upside_down.rough_below > 30);
  CHECK(upside_down.rough_above == 0);
  CloudMapBuilder yard({}), turned_yard({});
  yard.add(cloud);
  CHECK_FALSE(yard.build("yard").keyframes.empty());
  CHECK(yard.warnings().empty());
  turned_yard.add(turned);
  CHECK_FALSE(turned_yard.build("yard").keyframes.empty());
  REQUIRE_FALSE(turned_yard.warnings().empty());
  CHECK(turned_yard.warnings().front().find("its upper side is smoother") == 0);
}

TEST_CASE("rooms with furniture at the ceiling give a warning that they are upside down") {
  PointCloud cloud = two_rooms(0.05F);
  for (const float x : {1.0F, 5.5F, 9.0F, 11.5F, 14.0F})
    for (const float y : {0.5F, 3.5F}) add_rectangle({x, y, 0.75F}, {1.5F, 0, 0}, {0, 2, 0}, 0.05F, &cloud);
  Eigen::Matrix3d over;  // about x
  over << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  CloudMapBuilder upright({}), upside_down({});
  upright.add(cloud);
  upright.build("rooms");
  CHECK(upright.warnings().empty());
  upside_down.add(moved(cloud, Pose(over)));
  upside_down.build("rooms");
  REQUIRE_FALSE(upside_down.warnings().empty());
  CHECK(upside_down.warnings().back().find("is it upside down") != std::string::npos);
}

TEST_CASE("rooms whose y axis is up give a warning if z is taken as up, and none if y is") {
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  CloudMapOptions options;
  options.max_range_m = 5;
  CloudMapBuilder by_z(options);
  options.up = turn * Eigen::Vector3d::UnitZ();
  CloudMapBuilder by_y(options);
  const PointCloud cloud = moved(two_rooms(0.05F), Pose(turn));
  by_z.add(cloud);
  by_z.build("rooms");
  REQUIRE_FALSE(by_z.warnings().empty());
  CHECK(by_z.warnings().back().find("seen from a side it covers") == 0);
  by_y.add(cloud);
  by_y.build("rooms");
  CHECK(by_y.warnings().empty());
}

TEST_CASE("the up direction may be any axis, and unusable points and clouds are reported with the reason") {
  Eigen::Matrix3d turn;  // y is up
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  CloudMapOptions options;
  options.up = turn * Eigen::Vector3d::UnitZ();
  const SavedMap map = map_of_cloud(moved(two_rooms(0.05F), Pose(turn)), "rooms", options);
  REQUIRE_FALSE(map.keyframes.empty());
  for (const ArchivedKeyframe& k : map.keyframes) {
    CHECK(k.map_from_body.linear().col(2).isApprox(options.up, 1e-9));
    CHECK((turn.transpose() * k.map_from_body.translation()).z() < 2.5);
  }
  CHECK_THROWS_WITH_AS(map_of_cloud({}, "none.ply", {}), doctest::Contains("none.ply: holds no points"),
                       std::runtime_error);
  PointCloud dot;
  for (int i = 0; i < 100; ++i) dot.push_back(1, 2, 3);
  CHECK_THROWS_WITH_AS(map_of_cloud(dot, "dot.ply", {}), doctest::Contains("dot.ply: no floor"),
                       std::runtime_error);
  PointCloud broken = two_rooms(0.1F);
  broken.push_back(std::nanf(""), 0, 0);
  broken.push_back(0, std::numeric_limits<float>::infinity(), 0);
  broken.push_back(3e5F, 0, 0);
  CloudMapBuilder builder({});
  builder.add(broken);
  CHECK_FALSE(builder.build("rooms").keyframes.empty());
  REQUIRE_FALSE(builder.warnings().empty());
  CHECK(builder.warnings().front() ==
        "of its " + std::to_string(broken.size()) +
            " points, 2 that are not finite and 1 that are farther than 100 km from its origin are left "
            "out");
  CloudMapBuilder whole({});
  whole.add(two_rooms(0.1F));
  whole.build("rooms");
  CHECK(whole.warnings().empty());
  PointCloud nothing;
  for (int i = 0; i < 3; ++i) nothing.push_back(std::nanf(""), 0, 0);
  CHECK_THROWS_WITH_AS(map_of_cloud(nothing, "nan.ply", {}),
                       doctest::Contains("nan.ply: none of its 3 points is finite"), std::runtime_error);
  PointCloud millimetres = two_rooms(0.05F);
  for (auto* axis : {&millimetres.x, &millimetres.y, &millimetres.z})
    for (float& v : *axis) v *= 1000;
  CHECK_THROWS_WITH_AS(map_of_cloud(millimetres, "mm.ply", {}), doctest::Contains("is its unit not metres"),
                       std::runtime_error);
  PointCloud far;
  far.push_back(std::nanf(""), 0, 0);
  far.push_back(500123.4F, -5412345.6F, 312);
  CHECK_THROWS_WITH_AS(map_of_cloud(far, "far.ply", {}), doctest::Contains("--offset 500000,-5412000,0"),
                       std::runtime_error);
}

TEST_CASE("a map depends neither on the order in which the points of its cloud come, nor on threads") {
  const PointCloud cloud = two_rooms(0.05F);
  const SavedMap whole = map_of_cloud(cloud, "rooms", {});
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  CloudMapOptions threads;
  threads.threads = 3;
  CloudMapBuilder builder(threads);
  for (std::size_t begin = 0; begin < order.size(); begin += 999) {
    PointCloud part;
    for (std::size_t i = begin; i < std::min(begin + 999, order.size()); ++i)
      part.push_back(cloud.point(order[i]));
    builder.add(std::move(part));
  }
  const SavedMap parts = builder.build("rooms");
  REQUIRE(parts.keyframes.size() == whole.keyframes.size());
  for (std::size_t i = 0; i < whole.keyframes.size(); ++i) {
    CHECK(parts.keyframes[i].map_from_body.matrix() == whole.keyframes[i].map_from_body.matrix());
    CHECK(parts.keyframes[i].points.cloud()->x == whole.keyframes[i].points.cloud()->x);
    CHECK(parts.keyframes[i].points.cloud()->z == whole.keyframes[i].points.cloud()->z);
  }
}

TEST_CASE("a cloud far from its origin and a yard that is upside down are refused with the reason") {
  PointCloud far = two_rooms(0.1F);
  for (float& x : far.x) x += 4e6F;
  CHECK_THROWS_WITH_AS(map_of_cloud(far, "utm.ply", {}), doctest::Contains("utm.ply: none of its"),
                       std::runtime_error);
  // A yard with walls and boxes, without a ceiling.
  PointCloud yard;
  add_rectangle({0, 0, 0}, {30, 0, 0}, {0, 30, 0}, 0.07F, &yard);
  for (const float side : {0.0F, 30.0F}) {
    add_rectangle({side, 0, 0}, {0, 30, 0}, {0, 0, 4}, 0.07F, &yard);
    add_rectangle({0, side, 0}, {30, 0, 0}, {0, 0, 4}, 0.07F, &yard);
  }
  for (const float x : {8.0F, 15.0F, 22.0F}) {
    add_rectangle({x, 10, 0}, {2, 0, 0}, {0, 0, 2}, 0.07F, &yard);
    add_rectangle({x, 10, 0}, {0, 2, 0}, {0, 0, 2}, 0.07F, &yard);
  }
  CHECK_FALSE(map_of_cloud(yard, "yard.ply", {}).keyframes.empty());
  Eigen::Matrix3d over;  // about x
  over << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  yard = moved(yard, Pose(over));
  CHECK_THROWS_WITH_AS(map_of_cloud(yard, "yard.ply", {}), doctest::Contains("yard.ply: no floor"),
                       std::runtime_error);
  CloudMapOptions down;
  down.up = -Eigen::Vector3d::UnitZ();
  CHECK_FALSE(map_of_cloud(yard, "yard.ply", down).keyframes.empty());
}

TEST_CASE("the cloud of a map consists of the points of its keyframes, in the map's frame") {
  const SavedMap map = map_of_cloud(two_rooms(0.05F), "rooms", {});
  const PointCloud cloud = cloud_of_map(map, 0.1F);
  CHECK(cloud.size() > 2000);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    REQUIRE(cloud.x[i] > -0.1F);
    REQUIRE(cloud.x[i] < 16.1F);
    REQUIRE(cloud.z[i] > -0.1F);
    REQUIRE(cloud.z[i] < 2.6F);
  }
}

}  // namespace scanlock
