// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace scanlock::test {
namespace {

std::string resolved(const std::string& program) {
  const std::string ours = std::string(SCANLOCK_BIN_DIR) + "/" + program;
  return access(ours.c_str(), X_OK) == 0 ? ours : program;
}

[[noreturn]] void become(const CommandLine& command, const std::string& output, const std::string& errors) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends with a test that is killed
  const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int err = open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  std::vector<char*> arguments;
  for (const auto& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  execvp(resolved(command[0]).c_str(), arguments.data());
  _exit(127);
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "scanlock_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

Process::Process(const TemporaryFolder& folder, const CommandLine& command) {
  static int count = 0;
  output_path_ = folder / ("output" + std::to_string(++count));
  error_path_ = folder / ("errors" + std::to_string(count));
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) become(command, output_path_, error_path_);
}

Process::~Process() {
  if (code_) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Process::send(int signal) const {
  kill(pid_, signal);
}

std::optional<int> Process::wait(std::chrono::milliseconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!code_) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    } else if (std::chrono::steady_clock::now() > end) {
      return std::nullopt;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  return code_;
}

std::string Process::output() const {
  return read_file(output_path_);
}
std::string Process::errors() const {
  return read_file(error_path_);
}

std::string joined(const CommandLine& command) {
  std::string text;
  for (const std::string& word : command) text += word + " ";
  return text;
}

Result run(const TemporaryFolder& folder, const CommandLine& command) {
  Process process(folder, command);
  const auto code = process.wait(std::chrono::seconds(120));
  return {code.value_or(-1), process.output(), process.errors()};
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace scanlock::test
