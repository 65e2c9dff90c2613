// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the files that the programs write, and of earlier files in their place.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "../contains.hpp"
#include "align_samples.hpp"
#include "io/cloud_file.hpp"
#include "io/scan_directory.hpp"
#include "io/trajectory.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;
namespace fs = std::filesystem;

namespace {

/// A run that writes one file; the word OUT in its command stands for it.
struct Writer {
  CommandLine command;
  std::string output;  ///< its name
};

/// Small inputs of every kind, in a folder of their own.
struct Inputs {
  TemporaryFolder folder;
  std::string source = folder / "source.ply", target = folder / "target.ply", tum = folder / "a.tum",
              kitti = folder / "a.kitti", scans = folder / "scans", log = folder / "drive.lcmlog";

  Inputs() {
    scanlock::write_cloud(source, corner(1));
    scanlock::write_cloud(target, corner(2));
    scanlock::Trajectory trajectory(3);
    for (int i = 0; i < 3; ++i) {
      trajectory[static_cast<std::size_t>(i)].time_s = i;
      trajectory[static_cast<std::size_t>(i)].pose.translation().x() = i;
    }
    scanlock::write_tum(tum, trajectory);
    scanlock::write_kitti(kitti, trajectory);
    scanlock::ScanDirectoryWriter writer(scans);
    for (int i = 0; i < 3; ++i) writer.write({100000 * (i + 1), corner(static_cast<unsigned>(i))});
    writer.close();
    write_log(log, drive(4, 16, 900));
  }

  CommandLine align(const CommandLine& more) const {
    CommandLine command = {"scanlock-align", source, target, "--method", "robust-icp-plane"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }

  std::vector<Writer> writers() const {
    const CommandLine simulate = {"scanlock-simulate", "--world", "field", "--seconds", "0.3"};
    const auto simulating = [&](const CommandLine& more) {
      CommandLine command = simulate;
      command.insert(command.end(), more.begin(), more.end());
      return command;
    };
    return {
        {align({"--output", "OUT"}), "out.ply"},
        {align({"--picture", "OUT"}), "out.svg"},
        {align({target, "--chain", "--poses", "OUT"}), "out.tum"},
        {align({target, "--chain", "--output", "OUT"}), "out.pcd"},
        {{"scanlock-convert", scans, "OUT"}, "out.lcmlog"},
        {{"scanlock-convert", tum, "OUT"}, "out.kitti"},
        {{"scanlock-convert", kitti, "OUT"}, "out.tum"},
        {{"scanlock-evaluate", tum, tum, "--picture", "OUT"}, "out.svg"},
        {{"scanlock-evaluate", tum, tum, "--html", "OUT"}, "out.html"},
        {simulating({"OUT"}), "out.lcmlog"},
        {simulating({"/dev/null", "--truth", "OUT"}), "out.tum"},
        {{"scanlock-odometry", log, "--poses", "OUT"}, "out.tum"},
        {{"scanlock-odometry", log, "--kitti", "OUT"}, "out.txt"},
        {{"scanlock-odometry", log, "--output", "OUT"}, "out.lcmlog"},
        {{"scanlock-odometry", log, "--map", "OUT"}, "out.ply"},
        {{"scanlockd", "-l", "file://" + log + "?speed=0", "--out-url", "file://OUT?mode=w"}, "out.lcmlog"}};
  }

  CommandLine written_to(const Writer& writer, const std::string& path) const {
    CommandLine command = writer.command;
    for (std::string& word : command) {
      const std::size_t at = word.find("OUT");
      if (at != std::string::npos) word.replace(at, 3, path);
    }
    return command;
  }
};

CommandLine with(CommandLine command, const std::string& word) {
  command.push_back(word);
  return command;
}

/// Checks for exit code 1 and one line of error that begins with the program's name.
void check_refusal(const CommandLine& command, const Result& result) {
  CHECK(result.code == 1);
  CHECK(result.errors.rfind(command[0] + ": ", 0) == 0);
  CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
}

}  // namespace

TEST_CASE("no program overwrites a file without --force") {
  const Inputs inputs;
  for (const Writer& writer : inputs.writers()) {
    const std::string output = inputs.folder / writer.output;
    const CommandLine command = inputs.written_to(writer, output);
    CAPTURE(joined(command));
    write_file(output, "precious");
    const Result refused = run(inputs.folder, command);
    check_refusal(command, refused);
    CHECK(contains(refused.errors, output + ": is there already; --force overwrites it"));
    CHECK(refused.output.empty());
    CHECK(read_file(output) == "precious");
    CHECK(run(inputs.folder, with(command, "--force")).code == 0);
    CHECK(read_file(output).size() > 10);
    CHECK_FALSE(contains(read_file(output), "precious"));
    fs::remove(output);
    CHECK(run(inputs.folder, command).code == 0);
    CHECK(read_file(output).size() > 10);
    fs::remove(output);
  }
}

TEST_CASE("no program overwrites its own input, not even with --force") {
  const Inputs inputs;
  const std::string config = inputs.folder / "c.toml", link = inputs.folder / "link.ply",
                    transform = inputs.folder / "t.txt";
  write_file(config, "[tracker]\nthreads = 1\n");
  write_transform(transform, scanlock::Pose::Identity());
  fs::create_symlink(inputs.target, link);
  const CommandLine commands[] = {
      inputs.align({"--output", inputs.source}),
      inputs.align({"--output", link}),
      inputs.align({"--init", transform, "--picture", transform}),
      inputs.align({"--truth", transform, "--output", transform}),
      inputs.align({inputs.source, "--chain", "--output", inputs.source}),
      {"scanlock-convert", inputs.scans, inputs.scans + "/000001.bin"},
      {"scanlock-convert", inputs.tum, inputs.folder / "./a.tum"},
      {"scanlock-evaluate", inputs.tum, inputs.kitti, "--picture", inputs.kitti},
      {"scanlock-evaluate", inputs.tum, inputs.kitti, "--html", inputs.tum},
      {"scanlock-evaluate", inputs.log + ":LIDAR", inputs.tum, "--html", inputs.log},
      {"scanlock-odometry", inputs.log, "--output", inputs.log},
      {"scanlock-odometry", inputs.log, "-c", config, "--poses", config},
      {"scanlockd", "-l", "file://" + inputs.log, "--out-url", "file://" + inputs.log + "?mode=w"},
      {"scanlockd", "-l", "file://" + inputs.log, "--out-url", "file://" + inputs.log + "?mode=a"},
      {"scanlockd", "-c", config, "--out-url", "file://" + config + "?mode=w"}};
  const auto contents = [&] {
    std::string all;
    for (const std::string& file : {inputs.source, inputs.target, inputs.tum, inputs.kitti, inputs.log,
                                    config, transform, inputs.scans + "/000001.bin"})
      all += read_file(file);
    return all;
  };
  const std::string before = contents();
  for (const CommandLine& command : commands) {
    CAPTURE(joined(command));
    const Result result = run(inputs.folder, with(command, "--force"));
    check_refusal(command, result);
    CHECK(contains(result.errors, "--force does not overwrite an input"));
    CHECK(contents() == before);
  }
}

TEST_CASE("two outputs in one file are refused") {
  const Inputs inputs;
  const std::string output = inputs.folder / "out.txt";
  const CommandLine commands[] = {
      inputs.align({"--output", output, "--picture", output}),
      inputs.align({inputs.target, "--chain", "--poses", output, "--output", output}),
      {"scanlock-evaluate", inputs.tum, inputs.tum, "--picture", output, "--html", output},
      {"scanlock-simulate", "--seconds", "0.3", output, "--truth", output},
      {"scanlock-odometry", inputs.log, "--poses", output, "--kitti", output},
      {"scanlock-odometry", inputs.log, "--output", output, "--map", output}};
  for (const CommandLine& command : commands) {
    CAPTURE(joined(command));
    const Result result = run(inputs.folder, with(command, "--force"));
    check_refusal(command, result);
    CHECK(contains(result.errors, "two outputs, but one file"));
    CHECK_FALSE(fs::exists(output));
  }
}

TEST_CASE("the daemon refuses a map and an output log in one file") {
  const Inputs inputs;
  const std::string output = inputs.folder / "out";
  const CommandLine command = {"scanlockd", "-l",        "file://" + inputs.log + "?speed=0", "--map",
                               output,      "--out-url", "file://" + output + "?mode=w"};
  const Result result = run(inputs.folder, command);
  check_refusal(command, result);
  CHECK(contains(result.errors, "two outputs, but one file"));
  CHECK_FALSE(fs::exists(output));
}

TEST_CASE("a daemon that cannot start leaves its output log unchanged") {
  const Inputs inputs;
  const std::string output = inputs.folder / "out.lcmlog", damaged = inputs.folder / "damaged.map",
                    input = "file://" + inputs.log;
  write_file(damaged, "no map");
  const CommandLine starts[] = {
      {"scanlockd", "-l", input + "?speed=0", "--map", damaged},
      {"scanlockd", "-l", input + "?speed=0", "--map", inputs.folder / "none/a.map"},
      {"scanlockd", "-l", input + "?speed=fast"},
      {"scanlockd", "-l", input + "?sped=0"},
      {"scanlockd", "-l", "udpm://10.0.0.1:7667"}};
  for (CommandLine command : starts) {
    command.insert(command.end(), {"--out-url", "file://" + output + "?mode=w", "--force"});
    CAPTURE(joined(command));
    CHECK(run(inputs.folder, command).code == 1);
    CHECK_FALSE(fs::exists(output));
    write_file(output, "precious");
    CHECK(run(inputs.folder, command).code == 1);
    CHECK(read_file(output) == "precious");
    fs::remove(output);
  }
}

TEST_CASE("convert does not write one kind of file under the name of another") {
  const Inputs inputs;
  const std::pair<CommandLine, std::string> cases[] = {
      {{"scanlock-convert", inputs.scans, inputs.folder / "out.tum"}, "go into a .lcmlog"},
      {{"scanlock-convert", inputs.scans, inputs.folder / "out.kitti"}, "go into a .lcmlog"},
      {{"scanlock-convert", inputs.log, inputs.folder / "out.lcmlog"}, "go into a directory"},
      {{"scanlock-convert", inputs.log, inputs.folder / "out.ply"}, "holds more than one scan: --scan N"}};
  for (const auto& [command, words] : cases) {
    const Result result = run(inputs.folder, command);
    check_refusal(command, result);
    CHECK_MESSAGE(contains(result.errors, words), result.errors);
    CHECK_FALSE(fs::exists(command.back()));
  }
}

TEST_CASE("a cloud of a kind that cannot be written is refused before any work") {
  const Inputs inputs;
  const std::string cloud = inputs.folder / "out.foo", other = inputs.folder / "other";
  const CommandLine commands[] = {inputs.align({"--output", cloud, "--picture", other}),
                                  {"scanlock-odometry", inputs.log, "--map", cloud, "--output", other}};
  for (const CommandLine& command : commands) {
    const Result result = run(inputs.folder, command);
    check_refusal(command, result);
    CHECK(contains(result.errors, cloud + ": unknown kind of cloud"));
    CHECK(result.output.empty());
    CHECK_FALSE(fs::exists(other));
  }
}

TEST_CASE("a directory that holds scans is refused, and --force replaces the scans and no other file") {
  const Inputs inputs;
  const std::string log = inputs.folder / "a.lcmlog", out = inputs.folder / "out";
  REQUIRE(run(inputs.folder, {"scanlock-convert", inputs.scans, log}).code == 0);
  const CommandLine commands[] = {
      {"scanlock-convert", log, out},
      {"scanlock-simulate", "--world", "field", "--seconds", "0.3", "/dev/null", "--bin", out}};
  for (const CommandLine& command : commands) {
    CAPTURE(joined(command));
    scanlock::ScanDirectoryWriter writer(out);
    for (int i = 0; i < 9; ++i) writer.write({i + 1, corner(1)});
    writer.close();
    write_file(out + "/notes.txt", "notes");
    const std::string before = read_file(out + "/times.txt");
    const Result refused = run(inputs.folder, command);
    check_refusal(command, refused);
    CHECK(contains(refused.errors, "--force overwrites the scans in it"));
    CHECK(read_file(out + "/times.txt") == before);
    CHECK(run(inputs.folder, with(command, "--force")).code == 0);
    CHECK(scanlock::ScanDirectory(out, {}).size() == 3);
    CHECK(read_file(out + "/notes.txt") == "notes");
    fs::remove_all(out);
  }
}

TEST_CASE("an output that cannot be written to its end is exit 1 with the reason") {
  const Inputs inputs;
  for (const Writer& writer : inputs.writers()) {
    const std::string output = inputs.folder / writer.output;
    fs::create_symlink("/dev/full", output);
    const CommandLine command = inputs.written_to(writer, output);
    CAPTURE(joined(command));
    const Result result = run(inputs.folder, command);
    CHECK(result.code == 1);
    CHECK(contains(result.errors, command[0] + ": " + output + ": cannot "));
    CHECK(contains(result.errors, ": No space left on device"));
    fs::remove(output);
    const CommandLine nowhere = inputs.written_to(writer, inputs.folder / ("none/" + writer.output));
    const Result refused = run(inputs.folder, nowhere);
    check_refusal(nowhere, refused);
    CHECK(contains(refused.errors, ": No such file or directory"));
  }
}

TEST_CASE("a replay in which no scan was used writes neither map nor poses") {
  const Inputs inputs;
  const std::string map = inputs.folder / "map.ply", poses = inputs.folder / "poses.tum";
  const CommandLine command = {"scanlock-odometry", inputs.log, "--scan-channel", "OTHER", "--map", map,
                               "--poses",           poses};
  check_refusal(command, run(inputs.folder, command));
  CHECK_FALSE(fs::exists(map));
  CHECK_FALSE(fs::exists(poses));
}

TEST_CASE("an output file /dev/stdout and the printed result do not overwrite each other") {
  const Inputs inputs;
  const Result result =
      run(inputs.folder, {"scanlock-evaluate", inputs.tum, inputs.tum, "--html", "/dev/stdout", "--json"});
  CHECK(result.code == 0);
  const std::size_t page = result.output.find("</html>"), json = result.output.find("{\"poses\":3");
  CHECK(page != std::string::npos);
  CHECK(json != std::string::npos);
  CHECK(contains(result.output, "<html"));
}

TEST_CASE("with a closed standard output nothing is printed into a file that the program opens") {
  const Inputs inputs;
  const std::string open = inputs.folder / "open.lcmlog", closed = inputs.folder / "closed.lcmlog";
  REQUIRE(run(inputs.folder, {"scanlock-convert", inputs.scans, open}).code == 0);
  const Result result =
      run(inputs.folder, {"sh", "-c", "exec \"$0\" \"$@\" >&-",
                          std::string(SCANLOCK_BIN_DIR) + "/scanlock-convert", inputs.scans, closed});
  CHECK(result.code == 1);
  CHECK(contains(result.errors, "standard output cannot be written: Bad file descriptor"));
  CHECK(read_file(closed) == read_file(open));
}

TEST_CASE("output that cannot be printed is exit 1 with the reason") {
  const Inputs inputs;
  const std::string matches = inputs.folder / "matches.txt";
  write_file(matches, "1 0 0 1 3 3\n0 1 0 0 2 3\n2 2 1 -1 4 4\n");
  const CommandLine commands[] = {
      inputs.align({}),
      inputs.align({"--json"}),
      inputs.align({"--help"}),
      inputs.align({inputs.target, "--chain"}),
      inputs.align({inputs.target, "--chain", "--json"}),
      {"scanlock-align", "--correspondences", matches, "--epsilon", "0.1", "--json"},
      {"scanlock-convert", inputs.log, "--info"},
      {"scanlock-convert", inputs.log, "--info", "--json"},
      {"scanlock-convert", inputs.tum, inputs.folder / "out.kitti"},
      {"scanlock-convert", "--version"},
      {"scanlock-evaluate", inputs.tum, inputs.tum},
      {"scanlock-evaluate", inputs.tum, inputs.tum, "--json"},
      {"scanlock-simulate", "--world", "field", "--seconds", "0.3", "/dev/null"},
      {"scanlock-odometry", inputs.log},
      {"scanlock-odometry", inputs.log, "--json"},
      {"scanlockd", "--print-config"}};
  for (const CommandLine& command : commands) {
    CAPTURE(joined(command));
    CommandLine full = {"sh", "-c", "exec \"$0\" \"$@\" >/dev/full",
                        std::string(SCANLOCK_BIN_DIR) + "/" + command[0]};
    full.insert(full.end(), command.begin() + 1, command.end());
    const Result result = run(inputs.folder, full);
    CHECK(result.code == 1);
    CHECK(
        contains(result.errors, command[0] + ": standard output cannot be written: No space left on device"));
  }
}
