// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "io/destination.hpp"

namespace scanlock {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path) {
  throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
}

/// The temporary file beside the target; this process alone writes it while it is open. Its name is fixed, so
/// that killed writers leave at most one file, which the next writer reuses. It is locked, so that two
/// writers cannot mix their bytes. Errors name the target as the caller spelled it.
class TemporaryFile {
 public:
  TemporaryFile(std::string name, std::string target)
      : name_(std::move(name)), target_(std::move(target)), path_(target_ + ".scanlock-part") {
    fd_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd_ < 0) fail(name_);
    const bool locked_by_another = flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (locked_by_another || !is_still_there()) {
      close(fd_);
      throw std::runtime_error(name_ + ": another process is writing it");
    }
  }
  ~TemporaryFile() {
    if (!path_.empty()) unlink(path_.c_str());
    close(fd_);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void begin() {
    if (ftruncate(fd_, 0) != 0) fail(name_);
  }

  void append(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(fd_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(name_);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void sync() {
    if (fsync(fd_) != 0) fail(name_);
  }

  /// A target that is replaced keeps its permissions.
  void rename_to_target() {
    struct stat old = {};
    struct stat ours = {};
    const bool replaces = stat(target_.c_str(), &old) == 0 && fstat(fd_, &ours) == 0;
    if (replaces && ours.st_mode != old.st_mode && fchmod(fd_, old.st_mode & 07777) != 0) fail(name_);
    const int copy = dup(fd_);  // network file systems report write errors on close()
    if (copy < 0 || close(copy) != 0) fail(name_);
    if (rename(path_.c_str(), target_.c_str()) != 0) fail(name_);
    path_.clear();
  }

 private:
  /// The process that held the lock before may have renamed the file between our open() and flock().
  bool is_still_there() const {
    struct stat ours = {};
    struct stat named = {};
    return fstat(fd_, &ours) == 0 && lstat(path_.c_str(), &named) == 0 && ours.st_ino == named.st_ino &&
           ours.st_dev == named.st_dev;
  }

  std::string name_, target_, path_;
  int fd_ = -1;
};

/// The new name is stored in the directory, which has to reach the disk as well as the file.
void sync_directory_of(const fs::path& path) {
  const int fd = open(path.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;  // the file is already in place; a directory without read permission cannot be synced
  fsync(fd);
  close(fd);
}

void replace(const std::string& path, const std::function<void(const TakeBytes&)>& write, bool synced) {
  const Destination destination = destination_of(path);
  if (destination.kind == Destination::Kind::kDirectory) throw std::runtime_error(path + ": is a directory");
  if (destination.kind == Destination::Kind::kSpecial)
    throw std::runtime_error(path + ": not a regular file; it is not replaced");
  TemporaryFile temporary(path, destination.path);
  temporary.begin();
  write([&](std::string_view bytes) { temporary.append(bytes); });
  if (synced) temporary.sync();
  temporary.rename_to_target();
  if (synced) sync_directory_of(destination.path);
}

}  // namespace

void write_file_atomically(const std::string& path, const std::function<void(const TakeBytes&)>& write) {
  replace(path, write, true);
}

void replace_file(const std::string& path, std::string_view bytes) {
  replace(
      path, [&](const TakeBytes& take) { take(bytes); }, false);
}

}  // namespace scanlock
