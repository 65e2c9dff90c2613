// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/keyframe_archive.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "geometry/voxel_grid.hpp"
#include "lost_points.hpp"

using namespace scanlock;

namespace {

PointCloud ring(std::size_t n, float radius) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const float a = 6.2831853f * static_cast<float>(i) / static_cast<float>(n);
    cloud.push_back(radius * std::cos(a), radius * std::sin(a), 0.1f * static_cast<float>(i % 7));
  }
  return cloud;
}

Pose shifted(double x, double y) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, 0;
  return pose;
}

}  // namespace

TEST_CASE("the archive wants a keyframe only where no keyframe of similar reach is near") {
  KeyframeArchive archive(1000000);
  CHECK(archive.wants(2, {0, 0, 0}, 12));
  archive.add(1, shifted(0, 0), 12, ring(500, 12));
  CHECK_FALSE(archive.wants(2, {1.9, 0, 0}, 12));
  CHECK(archive.wants(2, {2.1, 0, 0}, 12));
  CHECK(archive.wants(2, {1.9, 0, 0}, 6));
}

TEST_CASE("a keyframe that is replaced leaves its body-up attitudes to the other keyframe") {
  constexpr std::int64_t kSecond = 1000000;
  KeyframeArchive archive(1000000);
  for (int i = 0; i < 10; ++i) archive.add(i * kSecond, shifted(2.5 * i, 0), 12, ring(500, 12));
  CHECK_FALSE(archive.wants(30 * kSecond, {0, 0.5, 0}, 12));
  CHECK(archive.wants(100 * kSecond, {0, 0.5, 0}, 12));
  Pose tilted = shifted(5, 0.4);
  tilted.linear() = so3_exp(Eigen::Vector3d(0.1, 0, 0));
  archive.note_body_up(shifted(5, 0));
  archive.add(100 * kSecond, shifted(5, 0.5), 12, ring(400, 12));
  archive.note_body_up(tilted);
  KeyframeArchive newer = archive;
  archive.replace(11, 3);
  CHECK(archive.keyframes().size() == 10);
  CHECK(archive.points() == 10 * 500);
  CHECK(archive.find(11) == nullptr);
  REQUIRE(archive.find(3) != nullptr);
  CHECK(archive.find(3)->utime == 2 * kSecond);
  CHECK(archive.find(3)->body_ups.size() == 2);
  newer.replace(3, 11);
  CHECK(newer.points() == 9 * 500 + 400);
  CHECK(newer.find(3) == nullptr);
  CHECK(newer.find(11)->body_ups.size() == 2);
}

TEST_CASE("keyframes are thinned, and the oldest keyframes are dropped at the limit of points") {
  KeyframeArchive archive(3001);
  for (int i = 0; i < 5; ++i) {
    archive.add(i, shifted(10 * i, 0), 20, ring(50000, 20));
    CHECK(archive.keyframes().back().points.size() <= 3000);
    CHECK(archive.keyframes().back().points.size() > 300);
    CHECK(archive.points() <= 3001);
  }
  CHECK(archive.keyframes().back().utime == 4);
  CHECK(archive.keyframes().front().utime > 0);
  KeyframeArchive copy(3001);
  copy.restore(archive.keyframes());
  CHECK(copy.keyframes().size() == archive.keyframes().size());
  copy.clear();
  CHECK(copy.empty());
  CHECK(copy.points() == 0);
}

TEST_CASE("a restored map may exceed the limit of points, and none of its keyframes is dropped") {
  KeyframeArchive whole(1000000), archive(250);
  for (int i = 0; i < 5; ++i) whole.add(i, shifted(10 * i, 0), 20, ring(100, 20));
  archive.restore(whole.keyframes());
  CHECK(archive.keyframes().size() == 5);
  for (int i = 5; i < 10; ++i) archive.add(i, shifted(10 * i, 0), 20, ring(100, 20));
  REQUIRE(archive.keyframes().size() == 7);  // five restored ones and two new ones
  CHECK(archive.keyframes()[4].id == 5);
  CHECK(archive.keyframes()[5].id == 9);
  archive.replace(2, 3);  // keyframes of a map that is not fixed may be replaced
  CHECK(archive.keyframes().size() == 6);
  archive.add(10, shifted(100, 0), 20, ring(100, 20));
  CHECK(archive.keyframes().size() == 6);
  CHECK(archive.keyframes()[3].id == 5);
  CHECK(archive.keyframes()[4].id == 10);
}

TEST_CASE("a map of which some points cannot be read is restored as a whole, with the reason") {
  KeyframeArchive whole(1000000), archive(1000000);
  for (int i = 0; i < 3; ++i) whole.add(i, shifted(10 * i, 0), 20, ring(100, 20));
  std::vector<ArchivedKeyframe> keyframes = whole.keyframes();
  CHECK(archive.restore(keyframes).empty());
  const PlaceSignature like = *keyframes[1].signature;
  keyframes[1].points = lost_points();
  CHECK(archive.restore(keyframes) == "yard.map: was changed");
  REQUIRE(archive.keyframes().size() == 3);
  CHECK(like.similarity(*archive.keyframes()[0].signature) > 0.9);
  CHECK(like.similarity(*archive.keyframes()[1].signature) == 0);
}

TEST_CASE("a submap of more than 600000 points equals the thinning of all points at once") {
  KeyframeArchive archive(2000000);
  PointCloud all;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3f eye(0.11F * static_cast<float>(i), 0.02F * static_cast<float>(i % 7), 0);
    archive.add(i, shifted(static_cast<double>(eye.x()), static_cast<double>(eye.y())), 20, ring(3000, 20));
    const PointCloud points = *archive.keyframes().back().points.cloud();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Eigen::Vector3f p = points.point(k) + eye;
      if (!(p.head<2>().squaredNorm() < 900)) continue;
      all.push_back(p);
      all.viewpoints.push_back(eye);
    }
  }
  REQUIRE(all.size() > 600000);
  const PointCloud expected = select(all, thin_by_voxel(all, 0.2F));
  const PointCloud found = submap_around(archive.keyframes(), Eigen::Vector3d::Zero(), 30, 0.2);
  CHECK(found.x == expected.x);
  CHECK(found.y == expected.y);
  CHECK(found.z == expected.z);
  CHECK(found.viewpoints == expected.viewpoints);
}

TEST_CASE("keyframes are found by id and moved, with their body-up attitudes") {
  KeyframeArchive archive(1000000);
  for (int i = 0; i < 4; ++i) {
    archive.add(i, shifted(10 * i, 0), 12, ring(500, 12),
                Constraint{static_cast<std::uint32_t>(i), 0, shifted(i, 0)});
    archive.note_body_up(shifted(10 * i, 0));
  }
  CHECK(archive.nearest({21, 3, 0}).id == 3);
  REQUIRE(archive.find(4) != nullptr);
  CHECK(archive.find(4)->utime == 3);
  CHECK(archive.find(4)->constraint->from_to.translation().x() == 3);
  CHECK(archive.find(0) == nullptr);
  CHECK(archive.find(5) == nullptr);
  Pose there = shifted(7, 7);
  there.linear() = so3_exp(Eigen::Vector3d(0.1, 0, 0));
  archive.move({{2, there}, {9, shifted(0, 0)}});
  CHECK(archive.find(2)->map_from_body.matrix() == there.matrix());
  CHECK(archive.find(1)->map_from_body.matrix() == shifted(0, 0).matrix());
  CHECK(archive.find(2)->body_ups[0].dot(there.linear().col(2).cast<float>()) == doctest::Approx(1));
}

TEST_CASE("a submap joins the keyframes around a centre in the axes of the map") {
  KeyframeArchive archive(1000000);
  PointCloud one;
  one.push_back(1, 0, 0.5f);
  Pose turned = shifted(100, 50);
  turned.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // 90 degrees
  archive.add(1, turned, 5, one);
  archive.add(2, shifted(103, 50), 5, one);
  archive.add(3, shifted(400, 50), 5, one);
  const PointCloud submap = submap_around(archive.keyframes(), {100, 50, 0}, 10, 0.2);
  REQUIRE(submap.size() == 2);  // in any order
  const std::size_t first = submap.x[0] < 2 ? 0 : 1;
  CHECK(submap.point(first).isApprox(Eigen::Vector3f(0, 1, 0.5f), 1e-5f));
  CHECK(submap.point(1 - first).isApprox(Eigen::Vector3f(4, 0, 0.5f), 1e-5f));
  CHECK(submap.eye(first) != submap.eye(1 - first));
}

TEST_CASE("body-up attitudes are kept with the nearest keyframe, a few degrees apart") {
  const auto tilted = [](double x, double radians) {
    Pose pose = shifted(x, 0);
    pose.linear() = so3_exp(Eigen::Vector3d(radians, 0, 0));
    return pose;
  };
  KeyframeArchive archive(1000000);
  archive.note_body_up(tilted(0, 0.2));  // the archive is empty
  archive.add(1, shifted(0, 0), 12, ring(500, 12));
  archive.add(2, shifted(50, 0), 12, ring(500, 12));
  for (int i = 0; i <= 20; ++i) archive.note_body_up(tilted(1, 0.011 * i));
  archive.note_body_up(tilted(49, 0.5));
  const std::vector<Eigen::Vector3d> near = body_ups_around(archive.keyframes(), {0, 0, 0}, 20);
  REQUIRE(near.size() == 5);  // 0, 0.055 and so on
  for (std::size_t i = 0; i < near.size(); ++i) {
    CHECK(near[i].norm() == doctest::Approx(1));
    for (std::size_t j = 0; j < i; ++j) CHECK(near[i].dot(near[j]) < std::cos(0.0499));
  }
  CHECK(body_ups_around(archive.keyframes(), {0, 0, 0}, 60).size() == 6);
  CHECK(body_ups_around(archive.keyframes(), {0, 200, 0}, 60).empty());
  for (int i = 0; i < 1000; ++i) archive.note_body_up(tilted(0, 0.06 * i));
  CHECK(archive.keyframes()[0].body_ups.size() <= kMostBodyUps);
}
