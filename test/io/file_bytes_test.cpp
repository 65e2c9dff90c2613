// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/file_bytes.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "io/lcm_log.hpp"
#include "io/output_files.hpp"
#include "io/scan_directory.hpp"
#include "temporary_directory.hpp"

namespace scanlock {
namespace {

namespace fs = std::filesystem;

/// Simulates a full disk: during its lifetime no file of this process grows beyond `bytes`.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    handler_ = signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  sighandler_t handler_;
};

/// Where the user is root, acts as a user without access to root's files.
class Unprivileged {
 public:
  Unprivileged() {
    if (root_) REQUIRE(seteuid(65534) == 0);
  }
  ~Unprivileged() {
    if (root_ && seteuid(0) != 0) std::abort();
  }
  Unprivileged(const Unprivileged&) = delete;
  Unprivileged& operator=(const Unprivileged&) = delete;

 private:
  const bool root_ = geteuid() == 0;
};

std::size_t entries_in(const std::string& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("a failed write keeps the old content of a file and leaves no partial file") {
  const TemporaryDirectory folder;
  const std::string old = folder / "old.svg", fresh = folder / "new.svg", large(100000, 'x');
  write_file_bytes(old, "precious");
  {
    const FullDisk full(5000);
    CHECK_THROWS_WITH(write_file_bytes(old, large), (old + ": cannot be written: File too large").c_str());
    CHECK_THROWS_WITH(write_file_bytes(fresh, large),
                      (fresh + ": cannot be written: File too large").c_str());
  }
  CHECK(file_bytes(old).size() == 8);
  {
    const FullDisk full(5000);
    // The error must have the name that the caller gave.
    const std::string relative = fs::relative(old).string();
    CHECK_THROWS_WITH(write_file_bytes(relative, large),
                      (relative + ": cannot be written: File too large").c_str());
  }
  CHECK(entries_in(folder / "") == 1);
  write_file_bytes(old, large);
  CHECK(file_bytes(old).size() == 100000);
}

TEST_CASE("a missing permission is reported, for outputs before any work") {
  const TemporaryDirectory folder;
  const std::string open = folder / "open", barred = folder / "barred", file = open + "/a.lcmlog";
  fs::permissions(folder / "", fs::perms(0755));
  for (const std::string& directory : {open, barred}) fs::create_directory(directory);
  write_file(file, std::string("precious"));
  write_file(barred + "/b.lcmlog", std::string("precious"));
  fs::permissions(file, fs::perms::none);
  fs::permissions(open, fs::perms(0555));
  fs::permissions(barred, fs::perms::none);
  {
    const Unprivileged user;
    CHECK_THROWS_WITH(read_file_bytes(file), (file + ": cannot open: Permission denied").c_str());
    CHECK_THROWS_WITH(LogReader{file}, (file + ": cannot open the log: Permission denied").c_str());
    const std::string inside = barred + "/b.lcmlog";
    CHECK_THROWS_WITH(read_file_bytes(inside), (inside + ": cannot open: Permission denied").c_str());
    CHECK_THROWS_WITH(LogReader{inside}, (inside + ": cannot open the log: Permission denied").c_str());
    for (const std::string& name : {open + "/new.svg", file})
      CHECK_THROWS_WITH(write_file_bytes(name, "text"),
                        (name + ": cannot be written: Permission denied").c_str());
    CHECK_THROWS_WITH(check_outputs({{}, {open + "/new.svg"}, ""}, false),
                      (open + "/new.svg: cannot be written: " + open + ": Permission denied").c_str());
    CHECK_THROWS_WITH(check_outputs({{}, {}, open + "/scans"}, false),
                      (open + "/scans: cannot be written: " + open + ": Permission denied").c_str());
    CHECK_THROWS_WITH(check_outputs({{}, {inside}, ""}, true), (inside + ": Permission denied").c_str());
  }
  fs::permissions(barred, fs::perms::owner_all);
  CHECK(file_bytes(barred + "/b.lcmlog").size() == 8);
}

TEST_CASE("a file that is replaced keeps its permissions, and a link its target") {
  const TemporaryDirectory folder;
  const std::string file = folder / "a.svg", link = folder / "link.svg";
  write_file_bytes(file, "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("a.svg", link);
  write_file_bytes(link, "newer");
  CHECK(fs::is_symlink(link));
  CHECK(file_bytes(file).size() == 5);
  CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("devices are written to, and their errors are reported") {
  write_file_bytes("/dev/null", "nothing");
  CHECK(fs::is_character_file("/dev/null"));
  CHECK_THROWS_WITH(write_file_bytes("/dev/full", "all"),
                    "/dev/full: cannot be written: No space left on device");
  const TemporaryDirectory folder;
  CHECK_THROWS_WITH(write_file_bytes(folder / "", "all"), ((folder / "") + ": is a directory").c_str());
}

TEST_CASE("a log on a full disk reports the reason, at once or when it is closed") {
  const std::vector<std::uint8_t> small(10), large(1000000);
  LogWriter writer("/dev/full");
  CHECK_THROWS_WITH(writer.write(0, "A", large), "/dev/full: cannot write the log: No space left on device");
  LogWriter late("/dev/full");
  late.write(0, "A", small);
  CHECK_THROWS_WITH(late.close(), "/dev/full: cannot finish the log: No space left on device");
}

TEST_CASE("overwriting a directory of scans removes all old scans and no other file") {
  const TemporaryDirectory folder;
  const std::string scans = folder / "scans";
  Scan scan;
  scan.points.push_back(1, 2, 3);
  scan.points.time = {0.f};
  const auto write = [&](int count, bool overwrite) {
    ScanDirectoryWriter writer(scans, overwrite);
    for (scan.utime = 1; scan.utime <= count; ++scan.utime) writer.write(scan);
    writer.close();
  };
  write(3, false);
  write_file(scans + "/notes.txt", std::string("notes"));
  scan.points.time.clear();
  write(2, true);
  CHECK(ScanDirectory(scans, {}).size() == 2);
  CHECK_FALSE(ScanDirectory(scans, {}).read(0).points.has_times());
  CHECK(fs::exists(scans + "/notes.txt"));
  fs::rename(scans + "/000001.bin", scans + "/lidar_1.bin");
  CHECK_THROWS_WITH(ScanDirectoryWriter(scans, true),
                    (scans + ": holds scans of other names (lidar_1.bin); name another directory").c_str());
  CHECK(fs::exists(scans + "/000000.bin"));
}

}  // namespace scanlock
