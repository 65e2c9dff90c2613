// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// What all programs have in common: help and version, one line for what is wrong, and the exit code. What
// CLI11 does with the arguments is compiled once, in command_line.cpp.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace scanlock {

/// Arguments that each are possible, but not together: exit 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is printed is a result, too: a disk that does not take it is a failure.
void check_standard_output(bool good);

void print(const std::string& text);

/// One line. Names of files and channels need not be UTF-8, which JSON has to be.
template <typename Json>
void print_json(const Json& json) {
  print(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Pictures are SVG; a name that says another format was not meant so. An empty name stands for no picture.
void check_picture_path(const std::string& path);

/// For an option that takes a finite number of 0 or more, or only above 0. (CLI11's own take NaN, and name a
/// range of 300 digits.)
CLI::Validator number_from_zero(bool zero_too);

/// For an option that takes a channel to write to or to choose.
CLI::Validator channel_name();

/// What --help says after the options: explanations, if any, and commands that are examples.
void explain(CLI::App& app, std::string text, const std::vector<std::string>& examples);

void say(const char* program, const char* sentence);

/// The whole of main(): `declare`s the options to the command line, does the `work`, whose result is the exit
/// code, and says in one line what went wrong.
int run_program(const char* program, const char* description, int argc, char** argv,
                const std::function<void(CLI::App&)>& declare, const std::function<int()>& work);

template <typename Options, typename Declare, typename Work>
int run_program(const char* program, const char* description, int argc, char** argv, const Declare& declare,
                const Work& work) {
  Options options;
  return run_program(
      program, description, argc, argv, [&](CLI::App& app) { declare(app, options); },
      [&]() -> int { return work(options); });
}

}  // namespace scanlock
