// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-convert and scanlock-evaluate as a person or a script meets them.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "../io/temporary_directory.hpp"
#include "io/cloud_file.hpp"
#include "io/trajectory.hpp"

namespace scanlock {
namespace {

struct Run {
  int exit_code = -1;
  std::string out, err;
};

Run run(const TemporaryDirectory& directory, const std::string& arguments) {
  const std::string out = directory / "stdout", err = directory / "stderr";
  const std::string command = SCANLOCK_BIN_DIR "/" + arguments + " >" + out + " 2>" + err;
  Run result;
  result.exit_code = WEXITSTATUS(std::system(command.c_str()));
  const Bytes out_bytes = file_bytes(out), err_bytes = file_bytes(err);
  result.out.assign(out_bytes.begin(), out_bytes.end());
  result.err.assign(err_bytes.begin(), err_bytes.end());
  return result;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// 200 m straight on at 1 m a pose; the estimate is 1 % too long.
void write_trajectories(const TemporaryDirectory& directory) {
  Trajectory reference, estimate;
  for (int i = 0; i <= 200; ++i) {
    StampedPose stamped;
    stamped.time_s = 100 + 0.1 * i;
    stamped.pose.translation().x() = i;
    reference.push_back(stamped);
    stamped.pose.translation().x() = 1.01 * i;
    estimate.push_back(stamped);
  }
  write_tum(directory / "reference.tum", reference);
  write_tum(directory / "estimate.tum", estimate);
}

}  // namespace

TEST_CASE("programs tell help and version and refuse wrong usage with 2") {
  TemporaryDirectory directory;
  for (const std::string program : {"scanlock-convert", "scanlock-evaluate"}) {
    CAPTURE(program);
    const Run help = run(directory, program + " --help");
    CHECK(help.exit_code == 0);
    CHECK(contains(help.out, "Usage:"));
    CHECK(help.err.empty());
    CHECK(contains(run(directory, program + " -V").out, program + " "));
    CHECK(run(directory, program).exit_code == 2);
    CHECK(run(directory, program + " a b --no-such-flag").exit_code == 2);
    const Run failed = run(directory, program + " " + (directory / "none") + " " + (directory / "b.tum"));
    CHECK(failed.exit_code == 1);
    CHECK(failed.out.empty());
    CHECK(lines(failed.err) == 1);
    CHECK(contains(failed.err, "none: no such file"));
  }
  CHECK(run(directory, "scanlock-evaluate a b --align foo").exit_code == 2);
  CHECK(run(directory, "scanlock-convert a b --type foo").exit_code == 2);
  CHECK(run(directory, "scanlock-convert a b --info").exit_code == 2);
}

TEST_CASE("evaluate prints one JSON object with the members of the contract") {
  TemporaryDirectory directory;
  write_trajectories(directory);
  const std::string files = (directory / "estimate.tum") + " " + (directory / "reference.tum");
  const Run result = run(directory, "scanlock-evaluate " + files + " --json --picture " +
                                        (directory / "p.svg") + " --html " + (directory / "p.html"));
  CHECK(result.exit_code == 0);
  CHECK(result.err.empty());
  CHECK(lines(result.out) == 1);
  for (const char* part : {"{\"poses\":201,\"matched\":201,\"length_m\":200.0,\"ate_m\":{\"rmse\":1.1",
                           "\"median\":", "\"max\":2.0", "\"rpe\":{\"1m\":{\"percent\":1.0",
                           "\"10m\":{\"percent\":", "\"100m\":{", "\"kitti\":{\"percent\":", "\"nees\":null,",
                           "\"deg_per_m\":0.0", "\"recovery_s\":[]}"})
    CHECK_MESSAGE(contains(result.out, part), part, " in ", result.out);
  CHECK(std::filesystem::file_size(directory / "p.svg") > 1000);
  CHECK(std::filesystem::file_size(directory / "p.html") > std::filesystem::file_size(directory / "p.svg"));
}

TEST_CASE("convert carries trajectories to and fro and scans into a log that it can tell about") {
  TemporaryDirectory directory;
  write_trajectories(directory);
  const std::string tum = directory / "reference.tum", kitti = directory / "r.kitti",
                    back = directory / "b.tum";
  CHECK(run(directory, "scanlock-convert " + tum + " " + kitti).exit_code == 0);
  CHECK(run(directory, "scanlock-convert " + kitti + " " + back + " --utime 100000000").exit_code == 0);
  CHECK(file_bytes(back) == file_bytes(tum));

  std::filesystem::create_directory(directory / "scans");
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.push_back(static_cast<float>(i), 1, 2);
  for (const char* name : {"scans/0.bin", "scans/1.ply", "scans/2.pcd"}) write_cloud(directory / name, cloud);
  const std::string log = directory / "a.lcmlog";
  CHECK(
      run(directory, "scanlock-convert " + (directory / "scans") + " " + log + " --channel TOP").exit_code ==
      0);
  const Run info = run(directory, "scanlock-convert " + log + " --info --json");
  CHECK(contains(info.out, "\"name\":\"TOP\",\"type\":\"bot_core.pointcloud2_t\",\"events\":3"));
  CHECK(contains(info.out, "\"first_utime\":1000000,\"last_utime\":1200000"));
  CHECK(contains(info.out, "\"truncated\":false"));
  const Run wrong = run(directory, "scanlock-convert " + log + " " + (directory / "out"));
  CHECK(wrong.exit_code == 1);
  CHECK(contains(wrong.err, "nothing on channel LIDAR; the log has TOP"));

  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 1);
  const Run cut = run(directory, "scanlock-convert " + log + " " + (directory / "out") + " --channel TOP");
  CHECK(cut.exit_code == 0);
  CHECK(contains(cut.out, "2 scans, 200 points"));
  CHECK(contains(cut.err, "a.lcmlog: its last event is cut short"));
  CHECK(read_cloud(directory / "out/000001.bin").x == cloud.x);
  CHECK(contains(run(directory, "scanlock-convert " + log + " --info").out, "TRUNCATED"));
}

}  // namespace scanlock
