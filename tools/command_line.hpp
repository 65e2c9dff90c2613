// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// What all programs have in common: their options, help and version, one line for what is wrong, and the exit
// code. CLI11, which takes seconds to compile, is in command_line.cpp alone.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

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

/// Of this process so far: peak resident memory.
double peak_rss_mb();

/// Threads that the machine can run at once, at least 1.
int machine_threads();

/// Pictures are SVG; a name that says another format was not meant so. An empty name stands for no picture.
void check_picture_path(const std::string& path);

/// A finite number, or nothing for other text.
std::optional<double> finite_number(const std::string& text);

/// What an option accepts. Errors of the command line name the option and what it takes: exit 2.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option required() const;
  /// --help shows the value that is there.
  Option default_shown() const;
  /// A finite number of 0 or more, or only above 0.
  Option from_zero() const;
  Option above_zero() const;
  Option within(int least, int most) const;
  Option one_of(const std::vector<std::string>& names) const;
  /// The name of a channel.
  Option channel() const;
  /// May be given again, with one value each time.
  Option repeated() const;
  /// So many values, with commas between them.
  Option comma_separated(int count) const;

 private:
  CLI::Option* option_;
};

/// The options and positional arguments that a program declares, in the order of its --help.
class CommandLine {
 public:
  explicit CommandLine(CLI::App& app) : app_(app) {}
  /// `names`: "-c,--config", or "LOG" for a positional argument. `value`: a string, a number, a vector of
  /// strings or of numbers, or an optional number, which holds the default and has to outlive the parsing.
  template <typename Value>
  Option option(const std::string& names, Value& value, const std::string& help);
  void flag(const std::string& names, bool& value, const std::string& help);
  /// What --help says after the options: explanations, if any, and commands that are examples.
  void explain(std::string text, const std::vector<std::string>& examples);

 private:
  CLI::App& app_;
};

void say(const char* program, const char* sentence);

/// The whole of main(): `declare`s the options to the command line, does the `work`, whose result is the exit
/// code, and says in one line what went wrong.
int run_program(const char* program, const char* description, int argc, char** argv,
                const std::function<void(CommandLine)>& declare, const std::function<int()>& work);

template <typename Options, typename Declare, typename Work>
int run_program(const char* program, const char* description, int argc, char** argv, const Declare& declare,
                const Work& work) {
  Options options;
  return run_program(
      program, description, argc, argv, [&](CommandLine line) { declare(line, options); },
      [&]() -> int { return work(options); });
}

}  // namespace scanlock
