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

namespace scanlock {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& what, int code) {
  throw std::runtime_error(path + ": " + what + ": " + std::strerror(code));
}

/// The file beside the target, ours alone while it is open. One name, so that a kill leaves one at most,
/// which the next writer takes over; a lock, so that two writers do not mix.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string path) : path_(std::move(path)) {
    fd_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd_ < 0) fail(path_, "cannot create", errno);
    if (flock(fd_, LOCK_EX | LOCK_NB) != 0 || !is_still_there()) {
      close(fd_);
      throw std::runtime_error(path_ + ": another process is writing it");
    }
  }
  ~TemporaryFile() {
    if (!path_.empty()) unlink(path_.c_str());
    close(fd_);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write_all(const std::vector<std::uint8_t>& bytes) {
    if (ftruncate(fd_, 0) != 0) fail(path_, "cannot write", errno);
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t written = write(fd_, bytes.data() + done, bytes.size() - done);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_, "cannot write", errno);
      done += static_cast<std::size_t>(written);
    }
  }

  void rename_to(const std::string& target) {
    if (fsync(fd_) != 0) fail(path_, "cannot write", errno);
    if (rename(path_.c_str(), target.c_str()) != 0) fail(target, "cannot be replaced", errno);
    path_.clear();
  }

 private:
  /// Whoever had it locked before may have renamed it since we opened it.
  bool is_still_there() const {
    struct stat ours = {};
    struct stat named = {};
    return fstat(fd_, &ours) == 0 && lstat(path_.c_str(), &named) == 0 && ours.st_ino == named.st_ino &&
           ours.st_dev == named.st_dev;
  }

  std::string path_;
  int fd_ = -1;
};

/// The name is in the directory's own data: it has to reach the disk too.
void sync_directory_of(const fs::path& path) {
  const fs::path directory = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const int fd = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;  // the file is there; a directory that cannot be read cannot be synced
  fsync(fd);
  close(fd);
}

}  // namespace

void write_file_atomically(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::error_code error;
  fs::path target = path;
  if (fs::is_symlink(target, error)) target = fs::weakly_canonical(target, error);
  if (fs::exists(target, error) && !fs::is_regular_file(target, error))
    throw std::runtime_error(path + ": not a regular file; it is not replaced");
  TemporaryFile temporary(target.string() + ".part");
  temporary.write_all(bytes);
  temporary.rename_to(target.string());
  sync_directory_of(target);
}

}  // namespace scanlock
