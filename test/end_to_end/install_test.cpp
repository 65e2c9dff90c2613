// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of an installation in a temporary folder, which the projects of test/examples use.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <scanlock/odometry_t.hpp>
#include <sstream>

#include "../contains.hpp"
#include "io/trajectory.hpp"
#include "process.hpp"

using namespace scanlock;
using namespace scanlock::test;
namespace fs = std::filesystem;

namespace {

const std::string kExamples = std::string(SCANLOCK_SOURCE_DIR) + "/test/examples/";

Eigen::Matrix4d matrix_in(const std::string& text) {
  std::istringstream stream(text);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) stream >> matrix(row, column);
  }
  return matrix;
}

double last_number_but(std::size_t behind, const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words.size() > behind ? std::stod(words[words.size() - 1 - behind]) : 1e9;
}

/// Distance of the last three numbers of a text from a position, metres.
double error_of_last_position(const std::string& text, const Eigen::Vector3d& position) {
  const Eigen::Vector3d p(last_number_but(2, text), last_number_but(1, text), last_number_but(0, text));
  return (p - position).norm();
}

std::string line_of(std::int64_t hash) {
  char text[32];
  std::snprintf(text, sizeof text, "%016llx\n", static_cast<unsigned long long>(hash));
  return text;
}

/// The names in a folder of the installed include path, sorted.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

TEST_CASE("programs of other projects build against the installation, and find the poses") {
  const TemporaryFolder folder;
  const std::string prefix = folder / "prefix", build = folder / "build";
  const auto ran = [&](const CommandLine& command) {
    Process process(folder, command);
    const int code = process.wait(std::chrono::minutes(10)).value_or(-1);
    const std::string what = joined(command), errors = process.errors();
    CAPTURE(what);
    CAPTURE(errors);
    CHECK(code == 0);
    return process.output();
  };
  ran({"cmake", "--install", fs::path(SCANLOCK_BIN_DIR).parent_path().string(), "--prefix", prefix});
  CHECK(names_in(prefix + "/include") == std::vector<std::string>{"scanlock"});
  ran({"cmake", "-S", kExamples, "-B", build, "-DCMAKE_PREFIX_PATH=" + prefix,
       "-DCMAKE_CXX_FLAGS=-O1 -Wall -Wextra -Werror"});
  ran({"cmake", "--build", build, "-j2"});

  const std::string log = folder / "drive.lcmlog", scans = folder / "scans";
  ran({"scanlock-simulate", "--world", "indoor", "--lidar", "vlp16", "--seconds", "4", "--seed", "3", log,
       "--truth", folder / "truth.tum"});
  ran({"scanlock-convert", log, scans});
  ran({"scanlock-odometry", log, "--output", folder / "poses.lcmlog", "--map", folder / "site.ply"});
  const Trajectory truth = read_tum(folder / "truth.tum");
  REQUIRE(truth.size() == 40);
  const auto first_from = [&](std::size_t i) { return truth.front().pose.inverse() * truth[i].pose; };

  const Eigen::Matrix4d aligned =
      matrix_in(ran({build + "/align", scans + "/000020.bin", scans + "/000000.bin"}));
  CHECK((aligned.topRightCorner<3, 1>() - first_from(20).translation()).norm() < 0.05);
  CHECK((aligned.topLeftCorner<3, 3>() - first_from(20).linear()).norm() < 0.02);

  ran({build + "/odometry", log, folder / "poses.tum"});
  const Trajectory poses = read_tum(folder / "poses.tum");
  REQUIRE(poses.size() > 30);
  CHECK((poses.back().pose.translation() - first_from(39).translation()).norm() < 0.05);

  const std::string found = ran({build + "/relocalise", folder / "site.ply", log});
  const double after_s = (found.empty() ? 0.0 : std::stod(found)) - truth.front().time_s;
  REQUIRE(after_s > 0);
  REQUIRE(after_s < 3.95);
  CHECK(error_of_last_position(found, first_from(std::lround(10 * after_s)).translation()) < 0.05);

  const std::string python =
      "from scanlock import odometry_t\nfrom scanlock.nav_msgs import Odometry\n"
      "Odometry.decode(Odometry().encode())\n"
      "print('%016x' % odometry_t._get_hash_recursive([]))";
  const std::string hash =
      ran({"env", "PYTHONPATH=" + prefix + "/lib/python3/dist-packages", "python3", "-c", python});
  CHECK(hash == line_of(odometry_t::getHash()));

  const std::string poses_url = "file://" + (folder / "poses.lcmlog") + "?speed=0";
  const std::string heard = ran({build + "/subscribe", poses_url});
  CHECK(std::count(heard.begin(), heard.end(), '\n') == 40);
  CHECK(contains(heard, " tracking epoch 0 "));
  CHECK(error_of_last_position(heard, first_from(39).translation()) < 0.05);

  // Debian has no Python module lcm: this stand-in plays a log.
  std::ofstream(folder / "lcm.py") << R"(import struct
class LCM:
    def __init__(self, url):
        self.log = open(url.removeprefix("file://").partition("?")[0], "rb")
    def subscribe(self, channel, handler):
        self.channel, self.handler = channel, handler
    def handle(self):
        header = self.log.read(28)
        if len(header) < 28:
            raise SystemExit
        *_, name, size = struct.unpack(">IqqII", header)
        channel, data = self.log.read(name).decode(), self.log.read(size)
        if channel == self.channel:
            self.handler(channel, data)
)";
  const std::string modules =
      "PYTHONPATH=" + std::string(folder / "") + ":" + prefix + "/lib/python3/dist-packages";
  CHECK(ran({"env", modules, "python3", kExamples + "subscribe.py", poses_url}) == heard);
}

TEST_CASE("the Python package goes where the python3 of the system finds it") {
  const TemporaryFolder folder;
  const std::string build = fs::path(SCANLOCK_BIN_DIR).parent_path().string();
  if (!fs::exists("/etc/debian_version")) {
    MESSAGE("skipped: no Debian");
    return;
  }
  for (const std::string prefix : {"/usr/local", "/usr"}) {
    CAPTURE(prefix);
    const Result installed = run(folder, {"env", "DESTDIR=" + (folder / "root"), "cmake", "--install", build,
                                          "--prefix", prefix, "--component", "python"});
    REQUIRE(installed.code == 0);
    const Result found = run(folder, {"/usr/bin/python3", "-c",
                                      "import os, site; print(sum(os.path.exists('" + (folder / "root") +
                                          "' + path + '/scanlock/odometry_t.py') for path in "
                                          "site.getsitepackages()))"});
    CHECK(found.output == "1\n");
    fs::remove_all(folder / "root");
  }
}

TEST_CASE("README shows the subscribers that the tests run") {
  const std::string readme = read_file(std::string(SCANLOCK_SOURCE_DIR) + "/README.md");
  for (const char* name : {"subscribe.cpp", "subscribe.py"}) {
    const std::string text = read_file(kExamples + name);
    const std::size_t begin = text.find("from here on.\n");
    REQUIRE(begin != std::string::npos);
    CHECK(contains(readme, text.substr(text.find('\n', begin) + 1)));
  }
}
