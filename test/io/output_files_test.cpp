// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/output_files.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <filesystem>
#include <stdexcept>

#include "../contains.hpp"
#include "temporary_directory.hpp"

namespace scanlock {
namespace {

namespace fs = std::filesystem;

/// The error for these files; empty when they are accepted.
std::string refusal(const RunFiles& files, bool force = false) {
  try {
    check_outputs(files, force);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

struct Folder : TemporaryDirectory {
  std::string a = *this / "a.ply", b = *this / "b.ply", none = *this / "none.ply", link = *this / "link.ply";
  Folder() {
    write_file(a, std::string("precious"));
    write_file(b, std::string("dear"));
  }
};

}  // namespace

TEST_CASE("an existing output is refused unless it is forced") {
  const Folder folder;
  CHECK(refusal({{folder.a}, {folder.none}, ""}) == "");
  CHECK(refusal({{folder.a}, {"", folder.none, folder.b}, ""}) ==
        folder.b + ": is there already; --force overwrites it");
  CHECK(refusal({{folder.a}, {folder.b}, ""}, true) == "");
  fs::create_symlink(folder.b, folder.link);
  CHECK(refusal({{folder.a}, {folder.link}, ""}) ==
        folder.link + ": is there already; --force overwrites it");
  CHECK(file_bytes(folder.b).size() == 4);
}

TEST_CASE("an output that is an input under any name is refused, forced or not") {
  const Folder folder;
  fs::create_symlink(folder.a, folder.link);
  const std::string hard = folder / "hard.ply", spelled = folder / "./x/../a.ply";
  fs::create_directory(folder / "x");
  fs::create_hard_link(folder.a, hard);
  const std::string relative = fs::relative(folder.a).string();
  for (const std::string& name : {folder.a, folder.link, hard, spelled, relative}) {
    for (const bool force : {false, true}) {
      CAPTURE(name);
      const std::string words = refusal({{folder.b, folder.a}, {name}, ""}, force);
      CHECK(contains(words, name + ": is an input, too"));
      CHECK(contains(words, "--force does not overwrite an input"));
      CHECK(contains(refusal({{folder.b, name}, {folder.a}, ""}, force), folder.a + ": is an input, too"));
    }
  }
  CHECK(refusal({{folder.b}, {hard}, ""}, true) == "");
}

TEST_CASE("an output that is a scan of an input directory is refused") {
  const Folder folder;
  fs::create_directories(folder / "scans/ptime");
  write_file(folder / "scans/000000.bin", Bytes(16));
  write_file(folder / "scans/ptime/000000.f32", Bytes(4));
  for (const std::string name : {"scans/000000.bin", "scans/ptime/000000.f32"})
    CHECK(contains(refusal({{folder / "scans"}, {folder / name}, ""}, true), "is an input, too"));
  CHECK(refusal({{folder / "scans"}, {folder / "scans/new.lcmlog"}, ""}) == "");
  CHECK(refusal({{folder / "scans"}, {folder.a}, ""}, true) == "");
}

TEST_CASE("two outputs in one file are refused, forced or not, also if the file does not exist yet") {
  const Folder folder;
  fs::create_symlink(folder.none, folder.link);
  for (const bool force : {false, true}) {
    for (const std::string& name : {folder.none, folder / "././none.ply", folder.link}) {
      CAPTURE(name);
      CHECK(refusal({{}, {folder.none, "", name}, ""}, force) ==
            folder.none + " and " + name + ": two outputs, but one file");
    }
  }
  fs::create_hard_link(folder.a, folder / "hard.ply");
  CHECK(contains(refusal({{}, {folder.a, folder / "hard.ply"}, ""}, true), "two outputs, but one file"));
  CHECK(refusal({{}, {folder.link}, ""}) == "");
}

TEST_CASE("devices, FIFOs and open descriptors are not refused as outputs") {
  const Folder folder;
  REQUIRE(mkfifo((folder / "fifo").c_str(), 0600) == 0);
  CHECK(refusal({{folder.a, "/dev/null"},
                 {"/dev/null", "/dev/null", "/dev/stdout", "/dev/stdout", folder / "fifo"},
                 ""}) == "");
}

TEST_CASE("an output in a missing folder, or that is a folder, is refused before any work") {
  const Folder folder;
  CHECK(contains(refusal({{}, {folder / "no/such/a.ply"}, ""}), "no/such/a.ply: cannot be written: "));
  CHECK(contains(refusal({{}, {folder / "no/such/a.ply"}, ""}), "No such file or directory"));
  CHECK(refusal({{}, {folder / ""}, ""}, true) == (folder / "") + ": is a directory; name a file");
  CHECK(contains(refusal({{}, {folder.a + "/b.ply"}, ""}), "Not a directory"));
  fs::create_symlink(folder.link, folder.link);
  CHECK(contains(refusal({{}, {folder.link}, ""}), "link.ply: Too many levels of symbolic links"));
}

TEST_CASE("a directory of scans is written if it is missing, empty or forced") {
  const Folder folder;
  fs::create_directory(folder / "empty");
  fs::create_directory(folder / "full");
  write_file(folder / "full/notes.txt", std::string("notes"));
  for (const std::string name : {"new", "new/", "new/deep", "empty"})
    CHECK(refusal({{folder.a}, {}, folder / name}) == "");
  CHECK(refusal({{folder.a}, {}, folder / "full"}) ==
        (folder / "full") + ": the directory is not empty; --force overwrites the scans in it");
  CHECK(refusal({{folder.a}, {}, folder / "full"}, true) == "");
  CHECK(refusal({{folder.b}, {}, folder.a}, true) == folder.a + ": is no directory; name a new one");
  const std::string holds = refusal({{folder / "full/notes.txt"}, {}, folder / "full/"}, true);
  CHECK(contains(holds, "holds the input " + (folder / "full/notes.txt")));
}

TEST_CASE("an output that the scans of a directory would overwrite is refused") {
  const Folder folder;
  const auto words = [&](const std::string& name) {
    return refusal({{}, {folder / name}, folder / "scans"}, true);
  };
  fs::create_directories(folder / "scans/ptime");
  for (const std::string name : {"scans/times.txt", "scans/000012.bin", "scans/ptime/000012.f32"})
    CHECK(contains(words(name), name + " and the scans in "));
  CHECK(words("scans/drive.lcmlog") == "");
  CHECK(words("scans.lcmlog") == "");
}

}  // namespace scanlock
