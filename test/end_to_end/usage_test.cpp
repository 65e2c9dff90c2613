// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the programs' errors for a wrong command line or an unusable file.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "../contains.hpp"
#include "align_samples.hpp"
#include "io/cloud_file.hpp"
#include "io/trajectory.hpp"
#include "process.hpp"

using namespace scanlock::test;
namespace fs = std::filesystem;

namespace {

const char* const kPrograms[] = {"scanlock-align",    "scanlock-command",  "scanlock-convert",
                                 "scanlock-evaluate", "scanlock-simulate", "scanlock-odometry",
                                 "scanlock-spy",      "scanlockd"};

}  // namespace

TEST_CASE("every program prints its help and version on standard output") {
  const TemporaryFolder folder;
  for (const std::string program : kPrograms) {
    for (const std::string flag : {"-h", "--help"}) {
      const Result help = run(folder, {program, flag});
      CHECK(help.code == 0);
      CHECK(help.errors.empty());
      CHECK(contains(help.output, "Usage: " + program));
      CHECK(contains(help.output, "\nExample"));
      CHECK(contains(help.output, "  " + program + " "));  // the example is a command of this program
    }
    for (const std::string flag : {"-V", "--version"}) {
      const Result version = run(folder, {program, flag});
      CHECK(version.code == 0);
      CHECK(version.output.rfind(program + " ", 0) == 0);
      CHECK(std::count(version.output.begin(), version.output.end(), '\n') == 1);
    }
  }
}

TEST_CASE("wrong usage is exit 2 and one line with the name of the program and a suggestion") {
  const TemporaryFolder folder;
  struct Wrong {
    CommandLine command;
    std::string words;
  };
  const Wrong cases[] = {
      {{"scanlock-align", "a.ply", "b.ply", "--voxl", "0.1"}, "--voxl: unknown flag; did you mean --voxel?"},
      {{"scanlock-align", "--voxl=0.1"}, "--voxl: unknown flag; did you mean --voxel?"},
      {{"scanlock-align", "a.ply", "b.ply", "-jsno"}, "-jsno: unknown flag; did you mean --json?"},
      {{"scanlock-align", "a.ply", "b.ply", "--out", "c.ply"}, "did you mean --output?"},
      {{"scanlock-align", "a.ply", "b.ply", "--frobnicate"},
       "--frobnicate: unknown flag; see scanlock-align --help"},
      {{"scanlock-align", "a.ply"}, "TARGET is required; see scanlock-align --help"},
      {{"scanlock-align", "a.ply", "b.ply", "--voxel", "-1"}, "--voxel: -1 is not a number of 0 or more"},
      {{"scanlock-align", "a.ply", "b.ply", "--voxel", "nan"}, "--voxel: nan is not a number of 0 or more"},
      {{"scanlock-align", "a.ply", "b.ply", "--epsilon", "0"}, "--epsilon: 0 is not a number above 0"},
      {{"scanlock-align", "a.ply", "b.ply", "--up", "nan,0,1"}, "--up must be finite"},
      {{"scanlock-convert", "a.ply", "a.map", "--offset", "nan,0,1"}, "--offset must be finite"},
      {{"scanlock-align", "a.ply", "b.ply", "c.ply"}, "more than two clouds need --chain"},
      {{"scanlock-align", "--correspondences", "m.txt"}, "--epsilon is required"},
      {{"scanlock-align", "--correspondences", "m.txt", "--epsilon", "1", "--no-prunning"},
       "did you mean --no-pruning?"},
      {{"scanlock-convert", "a", "b", "--chanel", "X"}, "--chanel: unknown flag; did you mean --channel?"},
      {{"scanlock-convert", "a"}, "OUT is missing (or --info)"},
      {{"scanlock-convert", "a.map", "b.map", "c"}, "each a .map: c"},
      {{"scanlock-convert", "a", "b", "c", "d"}, "not expected: d"},
      {{"scanlock-evaluate", "a", "--algn", "yaw"}, "--algn: unknown flag; did you mean --align?"},
      {{"scanlock-evaluate", "a", "b", "--align", "foo"}, "foo not in {"},
      {{"scanlock-simulate", "--wrld", "urban", "a.lcmlog"}, "--wrld: unknown flag; did you mean --world?"},
      {{"scanlock-simulate", "--world", "moon", "a.lcmlog"}, "unknown world 'moon'"},
      {{"scanlock-simulate", "--seconds", "0", "a.lcmlog"}, "seconds must be more than 0"},
      {{"scanlock-odometry", "a.lcmlog", "--thread", "2"}, "--thread: unknown flag; did you mean --threads?"},
      {{"scanlock-odometry"}, "LOG is required"},
      {{"scanlockd", "--scan-chanel", "A"}, "--scan-chanel: unknown flag; did you mean --scan-channel?"},
      {{"scanlock-odometry", "a.lcmlog", "--threads", "257"}, "--threads: Value 257 not in range 1 to 256"},
      {{"scanlock-simulate", "a.lcmlog", "--seed", "-1"}, "--seed: -1 is not a number of 0 or more"},
      {{"scanlock-simulate", "a.lcmlog", "--seconds", "0.01"}, "no whole scan"},
      {{"scanlock-simulate", "a.lcmlog", "--seconds", "5", "--event", "kidnap@5"},
       "an event at 5 s is not reached: the drive ends after 5 s"},
      {{"scanlock-simulate", "a.lcmlog", "--channel", ""},
       "--channel: '' is not a channel name: it needs 1 to 63 characters"},
      {{"scanlock-convert", "a", "b", "--channel", std::string(64, 'x')},
       "is not a channel name: it needs 1 to 63 characters"},
      {{"scanlockd", "--json"}, "--json needs --check"},
      {{"scanlockd", "stray"}, "not expected: stray"}};
  for (const Wrong& wrong : cases) {
    CAPTURE(joined(wrong.command));
    const Result result = run(folder, wrong.command);
    CHECK(result.code == 2);
    CHECK(result.output.empty());
    CHECK(result.errors.rfind(wrong.command[0] + ": ", 0) == 0);
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
    CHECK_MESSAGE(contains(result.errors, wrong.words), result.errors);
  }
  CHECK_FALSE(fs::exists("a.lcmlog"));
}

TEST_CASE("a picture is SVG, and no other format is written under its name") {
  const TemporaryFolder folder;
  const std::string cloud = folder / "cloud.ply", tum = folder / "a.tum", picture = folder / "x.png";
  scanlock::write_cloud(cloud, corner(1));
  scanlock::write_tum(tum, scanlock::Trajectory(3));
  for (const CommandLine& command : {CommandLine{"scanlock-align", cloud, cloud, "--picture", picture},
                                     CommandLine{"scanlock-evaluate", tum, tum, "--picture", picture}}) {
    const Result result = run(folder, command);
    CHECK(result.code == 1);
    CHECK(result.output.empty());
    CHECK(contains(result.errors, picture + ": pictures are written as SVG; name it " + (folder / "x.svg")));
    CHECK_FALSE(fs::exists(picture));
  }
}

/// Characters of the longest number in a text, from its first digit that is not 0.
static std::size_t longest_number(const std::string& text) {
  std::size_t longest = 0;
  for (std::size_t at = text.find_first_of("123456789"); at != std::string::npos;
       at = text.find_first_of("123456789", at)) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", at), text.size());
    longest = std::max(longest, end - at);
    at = end;
  }
  return longest;
}

TEST_CASE("text output is labelled and has at most 6 digits, and standard output holds the transform alone") {
  const TemporaryFolder folder;
  const std::string cloud = folder / "cloud.ply", log = folder / "a.lcmlog";
  scanlock::write_cloud(cloud, corner(1));
  const Result aligned = run(folder, {"scanlock-align", cloud, cloud, "--method", "robust-icp-plane"});
  CHECK(aligned.code == 0);
  CHECK(std::count(aligned.output.begin(), aligned.output.end(), '\n') == 4);
  CHECK(contains(aligned.errors, "\ninlier ratio             1\n"));
  CHECK(contains(aligned.errors, "\ndegenerate axes          none\n"));
  CHECK(contains(aligned.errors, " MB\n"));
  REQUIRE(run(folder, {"scanlock-simulate", "--world", "indoor", "--lidar", "planar", "--seconds", "1", log})
              .code == 0);
  const Result odometry = run(folder, {"scanlock-odometry", log});
  CHECK(odometry.code == 0);
  CHECK(contains(odometry.output, "scans            10, poses 10, way "));
  CHECK(contains(odometry.output, "\ntime of a scan   p50 "));
  for (const std::string& text : {aligned.errors, odometry.output}) {
    CHECK(text.find_first_of("{}[]\"") == std::string::npos);  // no JSON
    CHECK(longest_number(text) <= 6);
  }
}

TEST_CASE("scanlock-spy lists all missing parts at once, with the command that installs them") {
  const TemporaryFolder folder;
  const std::string spy = folder / "bin/scanlock-spy";
  fs::create_directory(folder / "bin");
  fs::copy_file(SCANLOCK_BIN_DIR "/scanlock-spy", spy);  // a copy has no scanlock.jar beside it
  const Result result = run(folder, {"env", "DISPLAY=", spy});
  CHECK(result.code == 1);
  CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
  CHECK(contains(result.errors, "scanlock-spy: missing: scanlock.jar (built where a JDK and lcm.jar are)"));
  CHECK(contains(result.errors, "sudo apt install default-jdk"));
  CHECK(contains(result.errors, "libjchart2d-java") == contains(result.errors, ", jchart2d.jar"));
  CHECK(contains(result.errors, ", then run cmake and build scanlock (or its package) again\n"));
}

TEST_CASE("scripts print their help and refuse wrong usage without installing or building anything") {
  const TemporaryFolder folder;
  const std::string touched = folder / "touched";
  for (const std::string program : {"apt-get", "dpkg-query", "sudo", "cmake", "ninja"}) {
    write_file(folder / program, "#!/bin/sh\ntouch " + touched + "\nexit 1\n");
    fs::permissions(folder / program, fs::perms::owner_all);
  }
  const std::string path = "PATH=" + (folder / "") + ":" + std::getenv("PATH");
  for (const std::string script : {"setup", "demo", "kidnaps", "benchmark"}) {
    CAPTURE(script);
    const std::string file = std::string(SCANLOCK_SOURCE_DIR) + "/tools/" + script;
    for (const std::string flag : {"-h", "--help"}) {
      const Result help = run(folder, {"env", path, file, flag});
      CHECK(help.code == 0);
      CHECK(help.output.rfind("usage: ", 0) == 0);
      CHECK(help.errors.empty());
    }
    const Result wrong = run(folder, {"env", path, file, "--frobnicate"});
    CHECK(wrong.code == 2);
    CHECK(wrong.output.empty());
    CHECK(wrong.errors.rfind(script + ": ", 0) == 0);
    CHECK(contains(wrong.errors, "--frobnicate"));
    CHECK(std::count(wrong.errors.begin(), wrong.errors.end(), '\n') == 1);
    CHECK_FALSE(fs::exists(touched));
  }
}

TEST_CASE("a file that cannot be read is exit 1 and one line that names it") {
  const TemporaryFolder folder;
  const std::string cloud = folder / "good.ply", tum = folder / "good.tum", log = folder / "good.lcmlog";
  scanlock::write_cloud(cloud, corner(1));
  scanlock::write_tum(tum, scanlock::Trajectory(3));
  REQUIRE(run(folder, {"scanlock-simulate", "--world", "field", "--seconds", "0.3", log}).code == 0);
  // IN stands for the file. No output file may be written.
  const std::string out = folder / "out";
  const std::pair<CommandLine, std::string> cases[] = {
      {{"scanlock-align", "IN", cloud, "--output", out + ".ply"}, ".ply"},
      {{"scanlock-align", "IN", cloud, "--method", "icp"}, ".pcd"},
      {{"scanlock-align", cloud, "IN", "--method", "4dof"}, ".bin"},
      {{"scanlock-align", cloud, "IN", "--picture", out + ".svg"}, ".xyz"},
      {{"scanlock-align", cloud, "IN", cloud, "--chain", "--poses", out + ".tum"}, ".ply"},
      {{"scanlock-align", cloud, cloud, "--init", "IN"}, ".txt"},
      {{"scanlock-align", cloud, cloud, "--truth", "IN"}, ".txt"},
      {{"scanlock-align", "--correspondences", "IN", "--epsilon", "0.1"}, ".txt"},
      {{"scanlock-convert", "IN", "--info"}, ".lcmlog"},
      {{"scanlock-convert", "IN", "--info", "--json"}, ".lcmlog"},
      {{"scanlock-convert", "IN", out}, ".lcmlog"},
      {{"scanlock-convert", "IN", out + ".tum"}, ".lcmlog"},
      {{"scanlock-convert", "IN", out + ".kitti"}, ".tum"},
      {{"scanlock-evaluate", "IN", tum, "--html", out + ".html"}, ".tum"},
      {{"scanlock-evaluate", tum, "IN"}, ".lcmlog"},
      {{"scanlock-evaluate", tum, "IN:POSES"}, ".lcmlog"},
      {{"scanlock-odometry", "IN", "--poses", out + ".tum", "--output", out + ".lcmlog", "--map",
        out + ".ply"},
       ".lcmlog"},
      {{"scanlockd", "-l", "file://IN?speed=0", "--out-url", "file://" + out + ".lcmlog?mode=w"}, ".lcmlog"}};
  for (const auto& [words, extension] : cases) {
    for (const std::string kind : {"missing", "directory", "empty", "random"}) {
      const std::string file = folder / (kind + extension);
      fs::remove_all(file);
      if (kind == "directory") fs::create_directory(file);
      if (kind == "empty") write_file(file, "");
      if (kind == "random") {
        std::mt19937 random(7);
        std::string bytes(4999, ' ');
        for (char& byte : bytes) byte = static_cast<char>(random());
        write_file(file, bytes);
      }
      CommandLine command = words;
      for (std::string& word : command) {
        const std::size_t at = word.find("IN");
        if (at != std::string::npos) word.replace(at, 2, file);
      }
      CAPTURE(joined(command));
      const Result result = run(folder, command);
      CHECK(result.code == 1);
      CHECK(result.output.empty());
      CHECK_MESSAGE(result.errors.rfind(command[0] + ": " + file, 0) == 0, result.errors);
      CHECK_MESSAGE(std::count(result.errors.begin(), result.errors.end(), '\n') == 1, result.errors);
      CHECK(std::none_of(result.errors.begin(), result.errors.end() - 1,
                         [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
      for (const std::string end : {"", ".ply", ".svg", ".tum", ".kitti", ".html", ".lcmlog"})
        CHECK_FALSE(fs::exists(out + end));
    }
  }
}
