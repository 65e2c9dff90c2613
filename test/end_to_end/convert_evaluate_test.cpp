// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the programs scanlock-convert and scanlock-evaluate.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>

#include "../contains.hpp"
#include "io/cloud_file.hpp"
#include "io/trajectory.hpp"
#include "process.hpp"

namespace scanlock::test {
namespace {

/// `line`: a program and its arguments, with blanks between them.
Result run_line(const TemporaryFolder& folder, const std::string& line) {
  std::istringstream words(line);
  return run(folder, CommandLine(std::istream_iterator<std::string>(words), {}));
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// 200 m straight on with 1 m per pose; the estimate is 1 % too long.
void write_trajectories(const TemporaryFolder& folder) {
  Trajectory reference, estimate;
  for (int i = 0; i <= 200; ++i) {
    StampedPose stamped;
    stamped.time_s = 100 + 0.1 * i;
    stamped.pose.translation().x() = i;
    reference.push_back(stamped);
    stamped.pose.translation().x() = 1.01 * i;
    estimate.push_back(stamped);
  }
  write_tum(folder / "reference.tum", reference);
  write_tum(folder / "estimate.tum", estimate);
}

}  // namespace

TEST_CASE("programs print help and version and exit with 2 on wrong usage") {
  TemporaryFolder folder;
  for (const std::string program : {"scanlock-convert", "scanlock-evaluate"}) {
    CAPTURE(program);
    const Result help = run_line(folder, program + " --help");
    CHECK(help.code == 0);
    CHECK(contains(help.output, "Usage:"));
    CHECK(help.errors.empty());
    CHECK(contains(run_line(folder, program + " -V").output, program + " "));
    CHECK(run_line(folder, program).code == 2);
    CHECK(run_line(folder, program + " a b --no-such-flag").code == 2);
    const Result failed = run_line(folder, program + " " + (folder / "none") + " " + (folder / "b.tum"));
    CHECK(failed.code == 1);
    CHECK(failed.output.empty());
    CHECK(lines(failed.errors) == 1);
    CHECK(contains(failed.errors, "none: no such file"));
  }
  CHECK(run_line(folder, "scanlock-evaluate a b --align foo").code == 2);
  CHECK(run_line(folder, "scanlock-convert a b --type foo").code == 2);
  CHECK(run_line(folder, "scanlock-convert a b --info").code == 2);
}

TEST_CASE("evaluate prints one JSON object with the members of the contract") {
  TemporaryFolder folder;
  write_trajectories(folder);
  const std::string files = (folder / "estimate.tum") + " " + (folder / "reference.tum");
  const Result result = run_line(folder, "scanlock-evaluate " + files + " --align none --json --picture " +
                                             (folder / "p.svg") + " --html " + (folder / "p.html"));
  CHECK(result.code == 0);
  CHECK(result.errors.empty());
  CHECK(lines(result.output) == 1);
  for (const char* part : {"{\"poses\":201,\"matched\":201,\"length_m\":200.0,\"ate_m\":{\"rmse\":1.1",
                           "\"median\":", "\"max\":2.0", "\"rpe\":{\"1m\":{\"percent\":1.0",
                           "\"10m\":{\"percent\":", "\"100m\":{",
                           "\"kitti\":{\"percent\":", "\"tracking\":{\"poses\":201,\"ate_m\":{\"rmse\":1.1",
                           "\"nees\":null,", "\"deg_per_m\":0.0", "\"recovery_s\":[]", "\"align\":\"none\"}"})
    CHECK_MESSAGE(contains(result.output, part), part, " in ", result.output);
  CHECK(std::filesystem::file_size(folder / "p.svg") > 1000);
  CHECK(run_line(folder, "scanlock-evaluate " + files + " --note foo").code == 2);
  const Result laid = run(folder, {"scanlock-evaluate", folder / "estimate.tum", folder / "reference.tum",
                                   "--note", "drive: the first"});
  CHECK(contains(laid.output, "\ndrive                the first\n"));
  CHECK(laid.output.substr(0, laid.output.find('\n')) == "aligned by           se3");
  CHECK(std::filesystem::file_size(folder / "p.html") > std::filesystem::file_size(folder / "p.svg"));
}

TEST_CASE("convert refuses a pipe as input, and leaves no partial file at the limit of the file size") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe.ply").c_str(), 0600) == 0);
  const Result pipe = run(folder, {"scanlock-convert", folder / "pipe.ply", folder / "site.map"});
  CHECK(pipe.code == 1);
  CHECK(contains(pipe.errors, "pipe.ply: not a regular file"));

  write_trajectories(folder);
  const Result limited =
      run(folder, {"bash", "-c", "ulimit -f 1; exec \"$@\"", "bash", SCANLOCK_BIN_DIR "/scanlock-convert",
                   folder / "reference.tum", folder / "reference.kitti"});
  CHECK(limited.code == 1);
  CHECK(contains(limited.errors, "reference.kitti: cannot be written: File too large"));
  for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
    CHECK(!contains(entry.path().string(), "reference.kitti"));
}

TEST_CASE("convert round-trips trajectories, and writes, describes and extracts logs of scans") {
  TemporaryFolder folder;
  write_trajectories(folder);
  const std::string tum = folder / "reference.tum", kitti = folder / "r.kitti", back = folder / "b.tum";
  CHECK(run_line(folder, "scanlock-convert " + tum + " " + kitti).code == 0);
  CHECK(run_line(folder, "scanlock-convert " + kitti + " " + back + " --utime 100000000").code == 0);
  CHECK(read_file(back) == read_file(tum));

  std::filesystem::create_directory(folder / "scans");
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.push_back(static_cast<float>(i), 1, 2);
  for (const char* name : {"scans/0.bin", "scans/1.ply", "scans/2.pcd"}) write_cloud(folder / name, cloud);
  const std::string log = folder / "a.lcmlog";
  CHECK(run_line(folder, "scanlock-convert " + (folder / "scans") + " " + log + " --channel TOP").code == 0);
  const Result info = run_line(folder, "scanlock-convert " + log + " --info --json");
  CHECK(contains(info.output, "\"name\":\"TOP\",\"type\":\"bot_core.pointcloud2_t\",\"events\":3"));
  CHECK(contains(info.output, "\"first_utime\":1000000,\"last_utime\":1200000"));
  CHECK(contains(info.output, "\"truncated\":false"));
  const Result wrong = run_line(folder, "scanlock-convert " + log + " " + (folder / "out"));
  CHECK(wrong.code == 1);
  CHECK(contains(wrong.errors, "nothing on channel LIDAR; the log has TOP"));

  const Result several =
      run_line(folder, "scanlock-convert " + log + " " + (folder / "a.pcd") + " --channel TOP");
  CHECK(several.code == 1);
  CHECK(contains(several.errors, "a folder named as OUT takes all, with --format pcd"));
  CHECK_FALSE(std::filesystem::exists(folder / "a.pcd"));
  const std::string second = " --channel TOP --scan 1";
  CHECK(run_line(folder, "scanlock-convert " + log + " " + (folder / "a.pcd") + second).code == 0);
  CHECK(read_cloud(folder / "a.pcd").x == cloud.x);
  CHECK(run_line(folder, "scanlock-convert " + log + " " + (folder / "a.tum") + second).code == 2);
  CHECK(run_line(folder, "scanlock-convert " + log + " " + (folder / "b.pcd") + " --scan -1").code == 2);
  CHECK(run_line(folder, "scanlock-convert " + log + " " + (folder / "ply") + " --channel TOP --format ply")
            .code == 0);
  CHECK(read_cloud(folder / "ply/000002.ply").x == cloud.x);

  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 1);
  const Result cut = run_line(folder, "scanlock-convert " + log + " " + (folder / "out") + " --channel TOP");
  CHECK(cut.code == 0);
  CHECK(contains(cut.output, "2 scans, 200 points"));
  CHECK(contains(cut.errors, "a.lcmlog: its last event is cut short"));
  CHECK(read_cloud(folder / "out/000001.bin").x == cloud.x);
  CHECK(contains(run_line(folder, "scanlock-convert " + log + " --info").output, "TRUNCATED"));
}

}  // namespace scanlock::test
