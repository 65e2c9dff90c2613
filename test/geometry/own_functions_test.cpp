// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests that the code on which poses and messages depend calls no function of the C library that may round
// differently on another machine.
#include <doctest/doctest.h>
#include <regex.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// All rooms (folders of src) except `evaluation`, whose pictures may differ in the last digit.
const std::vector<std::string> kRooms = {"geometry", "search",   "icp", "global", "odometry",
                                         "mapping",  "messages", "io",  "daemon", "simulation"};

// These functions of Eigen call std::sin and similar ones; the distributions of the standard library differ
// between implementations.
constexpr const char* kForeign =
    R"(std::(a?(sin|cos|tan)h?|atan2|exp|exp2|expm1|log|log2|log10|log1p|pow|hypot|cbrt|erfc?|[lt]gamma|fma)f?l?\()"
    R"(|\bAngleAxis|\bRotation2D|computeDirect|angularDistance|\.slerp\(|\.eulerAngles\(|\.canonicalEulerAngles\()"
    R"(|\blong double\b|\w_distribution<)";
// Without the header these names are functions of the C library.
constexpr const char* kOwn =
    R"((^|[^[:alnum:]_.:>])(exp|expm1|exp2|log|log1p|log2|sin|cos|sincos|asin|acos|atan2|hypot)\()";
const std::string kHeader = "#include \"geometry/elementary.hpp\"";

/// A regular expression of the C library, because GCC 12 warns about those of the standard library under a
/// sanitiser.
class Pattern {
 public:
  explicit Pattern(const char* text) { REQUIRE(regcomp(&compiled_, text, REG_EXTENDED | REG_NOSUB) == 0); }
  ~Pattern() { regfree(&compiled_); }
  Pattern(const Pattern&) = delete;
  Pattern& operator=(const Pattern&) = delete;
  bool in(const std::string& line) const { return regexec(&compiled_, line.c_str(), 0, nullptr, 0) == 0; }

 private:
  regex_t compiled_{};
};

}  // namespace

TEST_CASE("forbidden functions are found, and no others") {
  const Pattern foreign(kForeign), own(kOwn);
  for (const char* line : {"x = std::sin(y);", "std::atan2(y, x)", "std::log1pf(x)", "Eigen::AngleAxisd a;",
                           "a.slerp(t, b)", "long double x;", "std::normal_distribution<double> d;"})
    CHECK_MESSAGE(foreign.in(line), line);
  for (const char* line : {"std::sqrt(x)", "sin(x)", "a.log(x)", "std::logic(x)"})
    CHECK_MESSAGE(!foreign.in(line), line);
  for (const char* line : {"x = sin(y);", "exp(x)", "-log1p(x)"}) CHECK_MESSAGE(own.in(line), line);
  for (const char* line : {"se3_exp(x)", "p.log(x)", "q->exp(x)", "geo::sin(x)"})
    CHECK_MESSAGE(!own.in(line), line);
}

TEST_CASE("poses and messages take their elementary functions from geometry/elementary.hpp") {
  const Pattern foreign(kForeign), own(kOwn);
  int files = 0;
  for (const std::string& room : kRooms) {
    const fs::path folder = fs::path(SCANLOCK_SOURCE_DIR) / "src" / room;
    if (!fs::exists(folder)) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().stem();
      if (name == "elementary" || name == "elementary_angles") continue;
      ++files;
      std::ifstream file(entry.path());
      bool has_header = false;
      int number = 0;
      for (std::string line; std::getline(file, line);) {
        ++number;
        CAPTURE(entry.path().string());
        CAPTURE(number);
        if (line.find(kHeader) == 0) has_header = true;
        const std::string code = line.substr(0, line.find("//"));
        if (code.find('(') == std::string::npos && code.find('<') == std::string::npos) continue;
        CHECK_FALSE(foreign.in(code));
        if (!has_header) CHECK_FALSE(own.in(code));
      }
    }
  }
  CHECK(files > 200);
}
