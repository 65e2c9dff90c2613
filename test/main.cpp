// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace {

/// Writes a line for the beginning and the end of each test case to the file that SCANLOCK_TEST_RECORD names,
/// for tools/check: "begun NAME", then "passed SECONDS NAME", "failed SECONDS NAME" or "skipped SECONDS NAME:
/// REASON". A test case counts as skipped when it emits a message that begins with "skipped: ".
class Record final : public doctest::IReporter {
 public:
  explicit Record(const doctest::ContextOptions&) {
    if (const char* path = std::getenv("SCANLOCK_TEST_RECORD")) file_.open(path, std::ios::app);
  }
  void test_case_start(const doctest::TestCaseData& test) override {
    name_ = test.m_name;
    skipped_.clear();
    file_ << "begun " << name_ << std::endl;  // flushed: the test may crash
  }
  void test_case_end(const doctest::CurrentTestCaseStats& result) override {
    const bool failed = result.failure_flags != doctest::TestCaseFailureReason::None;
    file_ << (failed             ? "failed"
              : skipped_.empty() ? "passed"
                                 : "skipped")
          << ' ' << result.seconds << ' ' << name_;
    if (!failed && !skipped_.empty()) file_ << ": " << skipped_;
    file_ << std::endl;
  }
  void log_message(const doctest::MessageData& message) override {
    const std::string text = message.m_string.c_str(), mark = "skipped: ";
    if (text.rfind(mark, 0) == 0) skipped_ = text.substr(mark.size());
  }

  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}

 private:
  std::ofstream file_;
  std::string name_, skipped_;
};

REGISTER_LISTENER("record", 1, Record);

}  // namespace
