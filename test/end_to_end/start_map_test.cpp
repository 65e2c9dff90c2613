// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <tuple>

#include "../contains.hpp"
#include "io/cloud_file.hpp"
#include "io/map_file.hpp"
#include "io/trajectory.hpp"
#include "process.hpp"

using namespace scanlock;
using namespace scanlock::test;

namespace {

/// The largest distance, metres, of the last `count` poses to the poses with the same stamps.
double farthest(const Trajectory& some, const Trajectory& others, std::size_t count) {
  double most = -1;
  for (std::size_t i = some.size() - std::min(count, some.size()); i < some.size(); ++i) {
    for (const StampedPose& other : others) {
      if (std::abs(other.time_s - some[i].time_s) < 1e-3)
        most = std::max(most, (some[i].pose.translation() - other.pose.translation()).norm());
    }
  }
  return most;
}

/// A room of 12 m by 9 m, 2.5 m high, without a ceiling; the origin is near a corner. No point is on a border
/// of voxels of 0.1 m, so that rounding does not matter.
PointCloud room() {
  PointCloud cloud;
  for (int x = 0; x <= 120; ++x) {
    for (int y = 0; y <= 90; ++y) {
      const bool wall = x == 0 || x == 120 || y == 0 || y == 90;
      for (int z = 0; z <= (wall ? 25 : 0); ++z) {
        const Eigen::Vector3f p =
            0.1F * Eigen::Vector3i(x, y, z).cast<float>() + Eigen::Vector3f::Constant(0.05F);
        cloud.push_back(p.x(), p.y(), p.z());
      }
    }
  }
  return cloud;
}

}  // namespace

TEST_CASE(
    "a robot is relocalised and tracked in a bare cloud of another drive, and the cloud is not modified" *
    doctest::test_suite("long drives")) {
  const TemporaryFolder folder;
  const std::string log = folder / "map.lcmlog", other = folder / "run.lcmlog";
  const std::vector<std::string> drive = {"--world", "indoor", "--seconds", "10", "--seed", "31"};
  const auto simulate = [&](const std::string& to, const std::string& lidar) {
    std::vector<std::string> command = {"scanlock-simulate", to, "--lidar", lidar, "--truth", to + ".tum"};
    command.insert(command.end(), drive.begin(), drive.end());
    return run(folder, command).code;
  };
  REQUIRE(simulate(log, "os1-64") == 0);
  REQUIRE(simulate(other, "vlp16") == 0);
  const std::string site = folder / "site.map", cloud = folder / "site.ply";
  REQUIRE(run(folder, {"scanlockd", "-l", "file://" + log + "?speed=0", "--out-url",
                       "file://" + (folder / "out.lcmlog") + "?mode=w", "--map", site})
              .code == 0);
  const Result converted = run(folder, {"scanlock-convert", site, cloud});
  CAPTURE(converted.errors);
  REQUIRE(converted.code == 0);
  CHECK(read_cloud(cloud).size() > 10000);
  const std::string bytes = read_file(cloud), map_bytes = read_file(site);
  const std::string same = folder / "same.map";
  REQUIRE(run(folder, {"scanlock-odometry", log, "--map", same}).code == 0);
  CHECK(read_file(same) == map_bytes);
  write_file(same, "notes");
  const Result refused = run(folder, {"scanlock-odometry", log, "--map", same, "--force"});
  CHECK(refused.code == 1);
  CHECK(contains(refused.errors, "is not a scanlock map"));
  CHECK(read_file(same) == "notes");

  const Result there = run(
      folder, {"scanlock-odometry", other, "--start-map", cloud, "--poses", folder / "run.tum", "--json"});
  CAPTURE(there.errors);
  CAPTURE(there.output);
  REQUIRE(there.code == 0);
  CHECK(contains(there.output, "\"recoveries\":1,"));
  CHECK(contains(there.output, "\"found_after_s\":"));
  CHECK_FALSE(contains(there.output, "\"found_after_s\":null"));
  // The map's frame is that of the sensor at the first scan of its drive; the other drive begins at the same
  // pose.
  const Trajectory truth = read_tum(other + ".tum");
  Trajectory expected = truth;
  for (StampedPose& stamped : expected) stamped.pose = truth.front().pose.inverse() * stamped.pose;
  const Trajectory poses = read_tum(folder / "run.tum");
  CHECK(poses.size() == 100);
  CHECK(farthest(poses, expected, 60) > 0);
  CHECK(farthest(poses, expected, 60) < 0.1);
  CHECK(read_file(cloud) == bytes);
  CHECK(read_file(site) == map_bytes);  // the path to which a map that grows would be saved

  // The replay does not change a .map file either, which the daemon would extend.
  REQUIRE(run(folder, {"scanlock-odometry", other, "--start-map", site}).code == 0);
  CHECK(read_file(site) == map_bytes);

  // The cloud can be converted to a map; and with map.mode = extend the grown map is saved beside the cloud.
  const std::string made = folder / "made.map", grown = folder / "grown.ply";
  REQUIRE(run(folder, {"scanlock-convert", cloud, made}).code == 0);
  CHECK(read_map(made).keyframes.size() > 3);
  CHECK(run(folder, {"scanlock-convert", cloud, made}).code == 1);  // the file exists already
  std::filesystem::copy_file(cloud, grown);
  write_file(folder / "grow.toml", "[map]\nmode = \"extend\"\n");
  const Result growing =
      run(folder, {"scanlockd", "-c", folder / "grow.toml", "-l", "file://" + other + "?speed=0", "--out-url",
                   "file://" + (folder / "out2.lcmlog") + "?mode=w", "--map", grown});
  CAPTURE(growing.errors);
  REQUIRE(growing.code == 0);
  CHECK(read_file(grown) == bytes);
  CHECK(read_map(folder / "grown.map").keyframes.size() > 3);
}

TEST_CASE("a replay in the map of another site reports that the robot was not found") {
  const TemporaryFolder folder;
  write_cloud(folder / "room.ply", room());
  const Result result =
      run(folder, {"scanlock-odometry", std::string(SCANLOCK_SOURCE_DIR) + "/test/logs/drive_urban.lcmlog",
                   "--start-map", folder / "room.ply", "--picture", folder / "room.svg", "--json"});
  CAPTURE(result.errors);
  CHECK(result.code == 0);
  CHECK(contains(result.errors, "not found in " + (folder / "room.ply")));
  CHECK(contains(result.output, "\"found_after_s\":null"));
  const std::string picture = read_file(folder / "room.svg");
  CHECK(contains(picture, "not found in room.ply"));
  CHECK_FALSE(contains(picture, "class=\"place\""));  // searches in the robot's own map are not drawn either
}

TEST_CASE("a cloud whose y axis points upwards becomes, with --up, the map of the same cloud with z up") {
  const TemporaryFolder folder;
  const PointCloud upright = room();
  PointCloud lying;  // turned by 90 degrees about x
  for (std::size_t i = 0; i < upright.size(); ++i) {
    const Eigen::Vector3f p = upright.point(i);
    lying.push_back(p.x(), p.z(), -p.y());
  }
  write_cloud(folder / "z.ply", upright);
  write_cloud(folder / "y.ply", lying);
  REQUIRE(run(folder, {"scanlock-convert", folder / "z.ply", folder / "z.map"}).code == 0);
  REQUIRE(run(folder, {"scanlock-convert", folder / "y.ply", folder / "y.map", "--up", "y"}).code == 0);
  const SavedMap of_z = read_map(folder / "z.map"), of_y = read_map(folder / "y.map");
  REQUIRE(of_y.keyframes.size() == of_z.keyframes.size());
  for (std::size_t i = 0; i < of_z.keyframes.size(); ++i) {
    const Pose &y = of_y.keyframes[i].map_from_body, &z = of_z.keyframes[i].map_from_body;
    CHECK((y.translation() - z.translation()).norm() < 0.01);
    CHECK(y.linear().isApprox(z.linear(), 1e-6));
  }
  const Result cloud = run(folder, {"scanlock-convert", folder / "y.map", folder / "again.ply", "--up", "y"});
  CHECK(cloud.code == 2);
  CHECK(contains(cloud.errors, "--up needs a cloud IN and a map OUT"));
}

TEST_CASE("a cloud in UTM becomes, with --offset, the map of the same cloud near zero") {
  const TemporaryFolder folder;
  PointCloud near = room();
  for (auto* axis : {&near.x, &near.y, &near.z})
    // Off the faces of voxels, so that the result does not depend on rounding.
    for (float& v : *axis) v += 0.0137F;
  write_cloud(folder / "near.ply", near);
  std::ofstream far(folder / "far.pcd");
  far << "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << near.size()
      << "\nHEIGHT 1\nPOINTS " << near.size() << "\nDATA ascii\n"
      << std::fixed << std::setprecision(9);
  for (std::size_t i = 0; i < near.size(); ++i)
    far << near.x[i] - 500123.25 << ' ' << near.y[i] + 5412345.5 << ' ' << near.z[i] + 312 << '\n';
  far.close();
  REQUIRE(run(folder, {"scanlock-convert", folder / "near.ply", folder / "near.map"}).code == 0);
  CHECK(contains(run(folder, {"scanlock-convert", folder / "far.pcd", folder / "far.map"}).errors,
                 "--offset -500000,5412000,0"));
  REQUIRE(run(folder, {"scanlock-convert", folder / "far.pcd", folder / "far.map", "--offset",
                       "-500123.25,5412345.5,312"})
              .code == 0);
  const SavedMap of_near = read_map(folder / "near.map"), of_far = read_map(folder / "far.map");
  REQUIRE(of_near.keyframes.size() == of_far.keyframes.size());
  for (std::size_t i = 0; i < of_near.keyframes.size(); ++i)
    CHECK(of_near.keyframes[i].map_from_body.isApprox(of_far.keyframes[i].map_from_body, 1e-5));
  const Result cloud =
      run(folder, {"scanlock-convert", folder / "far.map", folder / "again.ply", "--offset", "1,2,3"});
  CHECK(cloud.code == 2);
  CHECK(contains(cloud.errors, "--offset needs a cloud IN and a map OUT"));
}

TEST_CASE("converting a cloud or a map to a file of another type fails with the types that it can become") {
  const TemporaryFolder folder;
  write_cloud(folder / "room.ply", room());
  write_map(folder / "site.map", {});
  for (const auto& [in, out, reason] :
       {std::tuple("room.ply", "room.tum", "room.tum: name the output .map: the cloud"),
        std::tuple("site.map", "two.map", "two.map: name the output .ply or .pcd: the map")}) {
    const std::string expected = reason;
    CAPTURE(expected);
    const Result result = run(folder, {"scanlock-convert", folder / in, folder / out});
    CHECK(result.code == 1);
    CHECK(contains(result.errors, expected));
    CHECK_FALSE(std::filesystem::exists(folder / out));
  }
}

TEST_CASE("a file that no map can be made of is exit 1 and one line with its name and the reason") {
  const TemporaryFolder folder;
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex ",
                    columns = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  write_cloud(folder / "empty.ply", {});
  write_file(folder / "nothing.ply", "");
  write_file(folder / "gigantic.ply", header + "1000000000000" + columns + "123456789012");
  write_file(folder / "gigantic.pcd",
             "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1000000000000\nHEIGHT 1\n"
             "DATA binary\n123456789012");
  write_file(folder / "cut.ply", header + "2" + columns + std::string(23, 'x'));
  write_file(folder / "damaged.pcd", "FIELDS x y z\nSIZE 4 4\n");
  for (const auto& [name, reason] :
       {std::pair("empty.ply", "holds no points"), std::pair("nothing.ply", "not a PLY file"),
        std::pair("gigantic.ply", "the file is cut short"),
        std::pair("gigantic.pcd", "the file is cut short"), std::pair("cut.ply", "the file is cut short"),
        std::pair("damaged.pcd", "SIZE has 2 entries")}) {
    const std::string file = name;
    CAPTURE(file);
    const Result result = run(folder, {"scanlock-convert", folder / file, folder / "site.map"});
    CHECK(result.code == 1);
    CHECK(contains(result.errors, file));
    CHECK(contains(result.errors, reason));
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(folder / "site.map"));
  }
}

TEST_CASE("maps without an overlap are not merged, and nothing is written") {
  const TemporaryFolder folder;
  write_map(folder / "a.map", {});
  write_map(folder / "b.map", {});
  const Result apart =
      run(folder, {"scanlock-convert", folder / "a.map", folder / "b.map", folder / "c.map"});
  CHECK(apart.code == 1);
  CHECK(contains(apart.errors, "b.map: no overlap with"));
  CHECK(std::count(apart.errors.begin(), apart.errors.end(), '\n') == 1);
  CHECK_FALSE(std::filesystem::exists(folder / "c.map"));
  CHECK(run(folder, {"scanlock-convert", folder / "a.map", folder / "b.map", folder / "c.ply"}).code == 2);
  CHECK(run(folder, {"scanlock-convert", folder / "a.map", folder / "b.map", folder / "b.map"}).code == 1);
  const Result none = run(folder, {"scanlock-convert", folder / "a.map", folder / "n.map", folder / "c.map"});
  CHECK(none.code == 1);
  CHECK(contains(none.errors, "n.map: no such file"));
}

TEST_CASE("an invalid start map is an error with its name and the reason") {
  const TemporaryFolder folder;
  const std::string log = std::string(SCANLOCK_SOURCE_DIR) + "/test/logs/drive_urban.lcmlog";
  PointCloud wall;
  for (int i = 0; i < 3000; ++i)
    wall.push_back(5, 0.1F * static_cast<float>(i % 60), 0.1F * static_cast<float>(i / 60));
  write_cloud(folder / "wall.ply", wall);
  write_cloud(folder / "empty.ply", {});
  write_file(folder / "cut.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 9\n");
  for (const auto& [name, reason] :
       {std::pair("wall.ply", "no floor on which"), std::pair("empty.ply", "holds no points"),
        std::pair("cut.ply", "cut.ply"), std::pair("none.ply", "no such file")}) {
    const std::string file = name;  // clang++ 14 cannot capture a structured binding
    CAPTURE(file);
    const Result result = run(folder, {"scanlock-odometry", log, "--start-map", folder / file});
    CHECK(result.code == 1);
    CHECK(contains(result.errors, file));
    CHECK(contains(result.errors, reason));
    const Result daemon =
        run(folder, {"scanlockd", "-l", "file://" + log + "?speed=0", "--out-url",
                     "file://" + (folder / "out.lcmlog") + "?mode=w", "--map", folder / file});
    CHECK(daemon.code == 1);
    CHECK(contains(daemon.errors, file));
  }
}
