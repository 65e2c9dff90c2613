// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "evaluation/svg.hpp"

namespace scanlock {
namespace {

Comparison loop_of(int poses) {
  Comparison comparison;
  comparison.estimate_name = "a<b>&\"c\"";
  comparison.reference_name = "truth";
  for (int i = 0; i < poses; ++i) {
    const double angle = 6.0 * i / poses;
    StampedPose stamped;
    stamped.time_s = 0.1 * i;
    stamped.pose.translation() = Eigen::Vector3d(100 * std::cos(angle), 60 * std::sin(2 * angle), angle);
    comparison.reference.push_back(stamped);
    stamped.pose.translation().x() += 0.5;
    comparison.estimate.push_back(stamped);
  }
  comparison.pairs = match_by_time(comparison.estimate, comparison.reference);
  comparison.evaluation = evaluate(comparison.pairs, comparison.estimate.size(), Overlay::kNone);
  return comparison;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// Whether each element is closed, in order: a test of well-formed XML without a parser.
bool is_balanced(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag[0] == '/') {
      if (open.empty() || "/" + open.back() != tag) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
  }
  return open.empty();
}

}  // namespace

TEST_CASE("thinning keeps the ends and the corners and drops points on the line") {
  Points2 line;
  for (int i = 0; i <= 100; ++i) line.push_back({i, 0.05 * (i % 2)});
  for (int i = 1; i <= 100; ++i) line.push_back({100, i});
  const Points2 thin = simplified(line, 0.2);
  REQUIRE(thin.size() == 3);
  CHECK(thin[1] == Eigen::Vector2d(100, 0));
  CHECK(thin[2] == Eigen::Vector2d(100, 100));
  CHECK(simplified({{0, 0}}, 1).size() == 1);
  CHECK(simplified({}, 1).empty());
  CHECK(simplified(Points2(50, Eigen::Vector2d(1, 1)), 0.1).size() == 2);  // standing still
}

TEST_CASE("steps and labels of axes are round") {
  CHECK(nice_step(10, 10) == doctest::Approx(1));
  CHECK(nice_step(11, 10) == doctest::Approx(2));
  CHECK(nice_step(0.7, 2) == doctest::Approx(0.5));
  CHECK(nice_step(6e4, 9) == doctest::Approx(1e4));
  CHECK(tick_label(0.30000000000000004, 0.1) == "0.3");
  CHECK(tick_label(-1e-17, 0.05) == "0.00");
  CHECK(tick_label(1200, 200) == "1200");
}

TEST_CASE("panel puts y upwards and keeps the scales equal") {
  const auto panel = SvgPanel::equal_scales({10, 20, 200, 100}, {0, 0}, {10, 10});
  const Eigen::Vector2d low = panel.to_pixels({0, 0}), high = panel.to_pixels({10, 10});
  CHECK(low.y() == doctest::Approx(120));
  CHECK(high.y() == doctest::Approx(20));
  CHECK(high.x() - low.x() == doctest::Approx(100));
  CHECK((low.x() + high.x()) / 2 == doctest::Approx(110));
}

TEST_CASE("picture holds both trajectories compactly and survives any name") {
  const std::string svg = trajectory_svg(loop_of(20000));
  CHECK(svg.size() < 60000);
  CHECK(is_balanced(svg));
  CHECK(count(svg, "class=\"estimate\" d=") == 3);  // legend, from above, height
  CHECK(count(svg, "class=\"error\" d=") == 1);
  CHECK(count(svg, "a&lt;b&gt;&amp;&quot;c&quot; against truth") == 1);
  CHECK(count(svg, "nan") == 0);
  CHECK(count(svg, "inf") == 0);
}

TEST_CASE("a picture of a single pose and of a sensor at rest contains neither nan nor inf") {
  for (const int poses : {1, 5}) {
    Comparison comparison = loop_of(poses);
    for (auto& stamped : comparison.reference) stamped.pose.setIdentity();
    comparison.estimate = comparison.reference;
    comparison.pairs = match_by_time(comparison.estimate, comparison.reference);
    comparison.evaluation = evaluate(comparison.pairs, comparison.estimate.size(), Overlay::kNone);
    const std::string svg = trajectory_svg(comparison);
    CHECK(is_balanced(svg));
    CHECK(count(svg, "nan") == 0);
    CHECK(count(svg, "inf") == 0);
  }
}

TEST_CASE("page is self-contained and holds the numbers") {
  Comparison comparison = loop_of(1000);
  comparison.notes = {{"daemon", "a < b & c"}};
  const std::string html = trajectory_html(comparison);
  CHECK(html.rfind("<!DOCTYPE html>", 0) == 0);
  CHECK(count(html, "<svg") == 1);
  for (const char* outside : {"src=", "href=", "url(", "@import", "<script"})
    CHECK(count(html, outside) == 0);
  CHECK(count(html, "<tr><td>daemon</td><td>a &lt; b &amp; c</td></tr>") == 1);
  CHECK(count(html, "<tr>") == result_rows(comparison).size());
  CHECK(count(html, "0.500 m") >= 1);  // the shift by half a metre
}

TEST_CASE("the results have a row for NEES where it is known") {
  Comparison comparison = loop_of(100);
  const auto without = result_rows(comparison);
  comparison.nees = Nees{2.345, 0.25, 12, 3};
  const auto rows = result_rows(comparison);
  REQUIRE(rows.size() == without.size() + 1);
  CHECK(rows.back().first == "NEES");
  CHECK(rows.back().second == "2.35 (mean of 12 poses), 3 expected; 25.0 % beyond 11.34, 1 % expected");
}

TEST_CASE("a kidnap is marked, and poses that do not track are drawn separately") {
  Comparison comparison = loop_of(600);
  CHECK(count(trajectory_svg(comparison), "class=\"kidnap\"") == 0);
  CHECK(count(trajectory_svg(comparison), "class=\"lost\"") == 0);
  for (std::size_t i = 300; i < 600; ++i) comparison.reference[i].pose.translation().y() += 9;
  for (int i = 0; i < 600; ++i)
    comparison.states.push_back(
        {0.1 * i, i < 302 || i > 330 ? TrackingState::kTracking : TrackingState::kLost});
  comparison.pairs = match_by_time(comparison.estimate, comparison.reference);
  comparison.kidnaps =
      examine_kidnaps(comparison.reference, comparison.pairs, comparison.states, Overlay::kNone);
  const std::string svg = trajectory_svg(comparison);
  CHECK(is_balanced(svg));
  CHECK(count(svg, "class=\"kidnap\"") == 1);
  CHECK(count(svg, "class=\"reference\"") == 2 + 1 + 1);  // two pieces, the legend, the height
  CHECK(count(svg, "kidnapped 9.") == 1);
  CHECK(count(svg, "not recovered") == 1);
  CHECK(count(svg, "class=\"lost\"") == 1 + 1 + 1);  // the path from above, the legend, the height
  comparison.split = split_errors(comparison.pairs, comparison.states, comparison.kidnaps, Overlay::kNone);
  CHECK(is_balanced(trajectory_svg(comparison)));
  CHECK(count(trajectory_svg(comparison), "error, tracking (m)") == 1);
  CHECK(count(trajectory_svg(comparison), "while tracking: rmse 0.5") == 1);
  const auto rows = result_rows(comparison);
  const auto value_of = [&](const std::string& what) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.first == what; });
    return row == rows.end() ? "no such row" : row->second;
  };
  CHECK(value_of("while tracking") == "300 poses");
  CHECK(value_of("  ATE rmse") == "0.500 m");  // the first row of this name; that of all poses follows
  CHECK(value_of("  until recovery").substr(0, 9) == "300 poses");
  CHECK(value_of("all poses") == "600 poses");
  CHECK(rows.back().first == "wrong jumps");
  CHECK(rows.back().second == "1");  // the estimate reports TRACKING at a wrong pose
}

}  // namespace scanlock
