// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/output_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "io/destination.hpp"
#include "io/scan_directory.hpp"

namespace scanlock {
namespace {

namespace fs = std::filesystem;
using Kind = Destination::Kind;

struct Output {
  std::string name;
  Destination destination;
};

/// The file of an input (a file, or a directory of scans) that `output` would overwrite; empty when it would
/// overwrite none.
std::string input_overwritten(const std::string& input, const Destination& output) {
  const Destination read = destination_of(input);
  if (read.kind == Kind::kFile && same_file(read, output)) return input;
  if (read.kind != Kind::kDirectory) return "";
  for (const fs::path& folder : {fs::path(input), fs::path(input) / "ptime"}) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (fs::equivalent(entry.path(), output.path, error)) return entry.path().string();
    }
  }
  return "";
}

void check_folder(const std::string& name, const fs::path& folder) {
  if (faccessat(AT_FDCWD, (folder / "").c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    throw std::runtime_error(name + ": cannot be written: " + folder.string() + ": " + std::strerror(errno));
}

void check_file(const Output& output, const std::vector<std::string>& inputs, bool force) {
  const auto& [name, destination] = output;
  if (destination.kind == Kind::kSpecial) return;
  if (destination.kind == Kind::kDirectory) throw std::runtime_error(name + ": is a directory; name a file");
  if (destination.kind == Kind::kFile) {
    for (const std::string& input : inputs) {
      const std::string read = input.empty() ? "" : input_overwritten(input, destination);
      if (read.empty()) continue;
      throw std::runtime_error(name + ": is an input, too" + (read == name ? "" : " (" + read + ")") +
                               "; name another output, for --force does not overwrite an input");
    }
    if (!force) throw std::runtime_error(name + ": is there already; --force overwrites it");
  }
  check_folder(name, fs::path(destination.path).parent_path());
}

bool lies_in(const fs::path& path, const fs::path& directory) {
  const fs::path relative = path.lexically_relative(directory);
  return !relative.empty() && *relative.begin() != "..";
}

void check_directory(const std::string& name, const RunFiles& files, const std::vector<Output>& outputs,
                     bool force) {
  const Destination directory = destination_of((fs::path(name) / "").parent_path().string());
  if (directory.kind == Kind::kFile || directory.kind == Kind::kSpecial)
    throw std::runtime_error(name + ": is no directory; name a new one");
  for (const std::string& input : files.inputs) {
    if (!input.empty() && lies_in(destination_of(input).path, directory.path))
      throw std::runtime_error(
          std::string(name)
              .append(": holds the input ")
              .append(input)
              .append("; name another directory, for --force does not overwrite an input"));
  }
  for (const Output& output : outputs) {
    const fs::path file = output.destination.path;
    if (lies_in(file, directory.path) &&
        is_scan_directory_name(*file.lexically_relative(directory.path).begin()))
      throw std::runtime_error(output.name + " and the scans in " + name + ": two outputs, but one file");
  }
  std::error_code error;
  if (directory.kind == Kind::kDirectory && !fs::is_empty(directory.path, error) && !force)
    throw std::runtime_error(name + ": the directory is not empty; --force overwrites the scans in it");
  fs::path there = directory.path;
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  check_folder(name, there);
}

}  // namespace

void check_outputs(const RunFiles& files, bool force) {
  std::vector<Output> outputs;
  for (const std::string& name : files.outputs) {
    if (name.empty()) continue;
    const Output output{name, destination_of(name)};
    check_file(output, files.inputs, force);
    for (const Output& other : outputs) {
      if (output.destination.kind != Kind::kSpecial && same_file(other.destination, output.destination))
        throw std::runtime_error(other.name + " and " + name + ": two outputs, but one file");
    }
    outputs.push_back(output);
  }
  if (!files.output_directory.empty()) check_directory(files.output_directory, files, outputs, force);
}

}  // namespace scanlock
