// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/trajectory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "temporary_directory.hpp"

namespace scanlock {
namespace {

Trajectory random_trajectory() {
  std::mt19937 rng(5);
  std::normal_distribution<double> normal;
  Trajectory trajectory;
  for (int i = 0; i < 200; ++i) {
    Vector6 xi;
    for (int k = 0; k < 6; ++k) xi[k] = normal(rng) * (k < 3 ? 1000 : 1);
    trajectory.push_back({1763695123.000001 + 0.100003 * i, se3_exp(xi)});
  }
  return trajectory;
}

void check_close(const Trajectory& a, const Trajectory& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    CHECK((a[i].pose.matrix() - b[i].pose.matrix()).cwiseAbs().maxCoeff() < 5e-9);
}

}  // namespace

TEST_CASE("TUM round trip keeps nine decimals and the microseconds") {
  TemporaryDirectory directory;
  const Trajectory trajectory = random_trajectory();
  write_tum(directory / "a.tum", trajectory);
  const Trajectory back = read_trajectory(directory / "a.tum");
  check_close(trajectory, back);
  for (std::size_t i = 0; i < back.size(); ++i)
    CHECK(std::llround(back[i].time_s * 1e6) == std::llround(trajectory[i].time_s * 1e6));
  for (std::size_t i = 0; i < back.size();
       ++i) {  // half a unit of the ninth decimal, and the rounding of doubles at 1e3
    CHECK((back[i].pose.translation() - trajectory[i].pose.translation()).cwiseAbs().maxCoeff() < 5.1e-10);
    const Eigen::Quaterniond q(back[i].pose.linear()), original(trajectory[i].pose.linear());
    CHECK(q.angularDistance(original) < 4e-9);
  }
}

TEST_CASE("KITTI round trip keeps every printed digit") {
  TemporaryDirectory directory;
  const Trajectory trajectory = random_trajectory();
  write_kitti(directory / "a.txt", trajectory);
  const Trajectory back = read_trajectory(directory / "a.txt");
  check_close(trajectory, back);
  CHECK(back[7].time_s == 7);
  write_kitti(directory / "b.txt", back);
  CHECK(file_bytes(directory / "a.txt") == file_bytes(directory / "b.txt"));
}

TEST_CASE("TUM lines are read as their format defines them") {
  TemporaryDirectory directory;
  write_file(directory / "a.tum",
             std::string("# time tx ty tz qx qy qz qw\r\n\n"
                         "12.5 1 -2 +3 0 0 0.7071067811865476 0.7071067811865476 # left\r\n"));
  const Trajectory trajectory = read_trajectory(directory / "a.tum");
  REQUIRE(trajectory.size() == 1);
  CHECK(trajectory[0].time_s == 12.5);
  CHECK(trajectory[0].pose.translation() == Eigen::Vector3d(1, -2, 3));
  CHECK((trajectory[0].pose.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm() < 1e-15);
}

TEST_CASE("trajectory errors name file and line") {
  TemporaryDirectory directory;
  const std::string good = "0 0 0 0 0 0 0 1\n";
  const std::string path = directory / "bad.tum";
  const auto message = [&](const std::string& text) -> std::string {
    write_file(path, text);
    try {
      read_trajectory(path);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  };
  CHECK(message(good + "1 0 0 0 0 0 0\n") ==
        path + ":2: a TUM line has 8 numbers (time tx ty tz qx qy qz qw), this one has 7");
  CHECK(message(good + "\n1 0 nan 0 0 0 0 1\n") == path + ":3: number 3 of the line is not finite");
  CHECK(message(good + "1 0 0 x4 0 0 0 1\n") == path + ":2: 'x4' is not a number");
  CHECK(message(good + "1 0 0 0 0 0 0 0\n").find(":2: the quaternion has length 0") != std::string::npos);
  CHECK(message("1 2 3\n").find("neither TUM") != std::string::npos);
  CHECK(message("# nothing\n").find("holds no pose") != std::string::npos);
  CHECK(message("1 0 0 0 0 1 0 0 0 0 2 0\n") == path + ":1: the matrix is not a rotation");
  CHECK(message("1 0 0 0 0 1 0 0 0 0 -1 0\n") == path + ":1: the matrix is not a rotation");
  CHECK(message(good + "1 1e999 0 0 0 0 0 1\n") == path + ":2: number 2 of the line is not finite");
  CHECK_THROWS_WITH_AS(read_tum(directory / "none.tum"), doctest::Contains("none.tum: no such file"),
                       std::runtime_error);
  CHECK_THROWS_WITH_AS(write_tum(directory / "no/a.tum", {}), doctest::Contains("a.tum"), std::runtime_error);
}

}  // namespace scanlock
