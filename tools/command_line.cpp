// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "command_line.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <thread>

#include "daemon/nearest_name.hpp"

namespace scanlock {
namespace {

/// Opens /dev/null for standard streams that are closed. Otherwise the first file that is opened would become
/// standard output, and results would be printed into it.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    const int wrong_way = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;  // reads and writes of it fail
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", wrong_way) < 0) _exit(1);
  }
}

std::string nearest_flag(const CLI::App& app, const std::string& letters) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options())
    known.insert(known.end(), option->get_lnames().begin(), option->get_lnames().end());
  return nearest_name(letters, known);
}

/// The error of the arguments as a sentence. An unknown flag is reported first, for it explains missing or
/// surplus values.
std::string sentence_of(const CLI::ParseError& error, const CLI::App& app) {
  const std::string see_help = "; see " + app.get_name() + " --help";
  for (const std::string& word : app.remaining()) {
    const std::size_t first_letter = word.find_first_not_of('-');
    if (first_letter == 0) continue;               // a surplus value
    if (first_letter == std::string::npos) break;  // the words after -- are no flags
    const std::string flag = word.substr(0, word.find('='));
    const std::string nearest = nearest_flag(app, flag.substr(first_letter));
    return flag + ": unknown flag" + (nearest.empty() ? see_help : "; did you mean --" + nearest + "?");
  }
  return error.what() + see_help;
}

/// The validators of CLI11 accept NaN, and name a range of 300 digits.
CLI::Validator number_from_zero(bool zero_too) {
  const auto check = [zero_too](const std::string& text) {
    const std::optional<double> value = finite_number(text);
    if (value && (zero_too ? *value >= 0 : *value > 0)) return std::string();
    return text + (zero_too ? " is not a number of 0 or more" : " is not a number above 0");
  };
  return CLI::Validator(check, "");
}

CLI::Validator channel_name() {
  constexpr std::size_t kLongest = 63;  // the limit of LCM
  const auto check = [](const std::string& text) {
    if (!text.empty() && text.size() <= kLongest) return std::string();
    return "'" + text + "' is not a channel name: it needs 1 to 63 characters";
  };
  return CLI::Validator(check, "");
}

}  // namespace

void check_standard_output(bool good) {
  if (good) return;
  const char* const reason = errno != 0 ? std::strerror(errno) : "an earlier write failed";
  throw std::runtime_error(std::string("standard output cannot be written: ") + reason);
}

void print(const std::string& text) {
  check_standard_output(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

double peak_rss_mb() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) * 1024e-6;  // ru_maxrss is in kibibytes
}

int machine_threads() {
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

bool has_extension(const std::string& path, std::initializer_list<const char*> extensions) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

void check_picture_path(const std::string& path) {
  const std::filesystem::path name(path);
  std::string extension = name.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension.empty() || extension == ".svg") return;
  throw std::runtime_error(path + ": pictures are written as SVG; name it " +
                           std::filesystem::path(name).replace_extension(".svg").string());
}

std::optional<double> finite_number(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value)) return value;
  return std::nullopt;
}

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::default_shown() const {
  option_->capture_default_str();
  return *this;
}

Option Option::from_zero() const {
  option_->check(number_from_zero(true));
  return *this;
}

Option Option::above_zero() const {
  option_->check(number_from_zero(false));
  return *this;
}

Option Option::within(int least, int most) const {
  option_->check(CLI::Range(least, most).description(""));
  return *this;
}

Option Option::one_of(const std::vector<std::string>& names) const {
  option_->check(CLI::IsMember(names));
  return *this;
}

Option Option::channel() const {
  option_->check(channel_name());
  return *this;
}

Option Option::repeated() const {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::comma_separated(int count) const {
  option_->delimiter(',')->expected(count);
  return *this;
}

template <typename Value>
Option CommandLine::option(const std::string& names, Value& value, const std::string& help) {
  return Option(app_.add_option(names, value, help));
}
template Option CommandLine::option(const std::string&, std::string&, const std::string&);
template Option CommandLine::option(const std::string&, double&, const std::string&);
template Option CommandLine::option(const std::string&, int&, const std::string&);
template Option CommandLine::option(const std::string&, std::int64_t&, const std::string&);
template Option CommandLine::option(const std::string&, std::uint64_t&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<double>&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<int>&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<std::size_t>&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<double>&, const std::string&);

void CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
  app_.add_flag(names, value, help);
}

void CommandLine::explain(std::string text, const std::vector<std::string>& examples) {
  if (!text.empty()) text += "\n\n";
  text += examples.size() > 1 ? "Examples:" : "Example:";
  for (const std::string& example : examples) text += "\n  " + example;
  app_.footer(text);
}

void say(const char* program, const char* sentence) {
  std::fprintf(stderr, "%s: %s\n", program, sentence);
}

int run_program(const char* program, const char* description, int argc, char** argv,
                const std::function<void(CommandLine)>& declare, const std::function<int()>& work) {
  occupy_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of file size (ulimit -f) then returns an error
  try {
    std::cerr.tie(nullptr);  // it would flush standard output without a check of the result
    CLI::App app(description, program);
    app.set_help_flag("-h,--help", "print this help and exit");
    app.set_version_flag("-V,--version", std::string(program) + " " + SCANLOCK_VERSION,
                         "print the version and exit");
    declare(CommandLine(app));
    int code = 0;
    try {
      app.parse(argc, argv);
      code = work();
    } catch (const CLI::CallForVersion& version) {
      print(std::string(version.what()) + "\n");
    } catch (const CLI::Success&) {
      print(app.help());
    } catch (const CLI::ParseError& error) {
      say(program, sentence_of(error, app).c_str());
      return 2;
    } catch (const UsageError& error) {
      say(program, (error.what() + std::string("; see ") + program + " --help").c_str());
      return 2;
    }
    errno = 0;
    check_standard_output(std::fflush(stdout) == 0 && std::ferror(stdout) == 0);
    return code;
  } catch (const std::exception& error) {
    say(program, error.what());
    return 1;
  }
}

}  // namespace scanlock
