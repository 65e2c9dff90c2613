// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The common part of all programs: options, help and version, error messages of one line, and the exit code.
// CLI11, which takes seconds to compile, is included in command_line.cpp only.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace scanlock {

/// Arguments that are valid each, but not together: exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws where standard output could not be written, as on a full disk: printed text is a result, too.
void check_standard_output(bool good);

void print(const std::string& text);

/// Prints one line. JSON has to be UTF-8: bytes of names of files and channels that are not are replaced.
template <typename Json>
void print_json(const Json& json) {
  print(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Peak resident memory of this process so far, in units of 10^6 bytes.
double peak_rss_mb();

/// The number of threads that the machine can run at once, at least 1.
int machine_threads();

/// Whether the extension of the path is one of these, each with its dot.
bool has_extension(const std::string& path, std::initializer_list<const char*> extensions);

/// Throws for the name of a picture that has the extension of another format than SVG. An empty name means no
/// picture.
void check_picture_path(const std::string& path);

/// The finite number that the text is, or nothing for other text.
std::optional<double> finite_number(const std::string& text);

/// Restricts the values of an option. Errors of the command line name the option and its valid values: exit
/// code 2.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option required() const;
  /// --help shows the default value.
  Option default_shown() const;
  /// The value is a finite number: of 0 or more, or above 0.
  Option from_zero() const;
  Option above_zero() const;
  Option within(int least, int most) const;
  Option one_of(const std::vector<std::string>& names) const;
  /// The value is the name of a channel.
  Option channel() const;
  /// The option may be repeated, with one value each time.
  Option repeated() const;
  /// The option takes `count` values, separated by commas.
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
  /// Text of --help after the options: explanations, if any, and example commands.
  void explain(std::string text, const std::vector<std::string>& examples);

 private:
  CLI::App& app_;
};

void say(const char* program, const char* sentence);

/// The whole of main(): `declare` adds the options to the command line, and `work` returns the exit code. An
/// error is printed as one line.
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
