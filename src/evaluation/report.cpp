// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "evaluation/svg.hpp"

namespace scanlock {
namespace {

const char* const kSvgStyle = R"(<style>
text { font-family: "DejaVu Sans", Verdana, Helvetica, sans-serif; fill: #202124; }
.title { font-size: 20px; font-weight: bold; }
.axis { font-size: 13px; }
.tick { font-size: 11px; fill: #5f6368; }
.halo { paint-order: stroke; stroke: #ffffff; stroke-width: 4px; stroke-linejoin: round; }
.panel { fill: #ffffff; stroke: #bdc1c6; }
.grid { stroke: #eceff1; fill: none; }
.bar { stroke: #202124; stroke-width: 2; fill: none; }
.reference { stroke: #b0b6bd; stroke-width: 5; fill: none; stroke-linejoin: round; stroke-linecap: round; }
.estimate { stroke: #1a56c4; stroke-width: 1.8; fill: none; stroke-linejoin: round; stroke-linecap: round; }
.lost { stroke: #e8710a; stroke-width: 2.2; stroke-dasharray: 2 5; fill: none; stroke-linecap: round; }
.kidnap { stroke: #a50e8a; stroke-width: 2; stroke-dasharray: 9 5; fill: none; }
.kidnap-end { fill: none; stroke: #a50e8a; stroke-width: 3; }
.kidnap-line { stroke: #a50e8a; stroke-width: 1; stroke-dasharray: 9 5; fill: none; }
.error { stroke: #c5221f; stroke-width: 1.6; fill: none; stroke-linejoin: round; }
.start { fill: none; stroke: #188038; stroke-width: 3; }
.reference-end { fill: #b0b6bd; stroke: #5f6368; }
.estimate-end { fill: #1a56c4; stroke: #ffffff; }
</style>
)";

constexpr double kWidth = 1000, kHeight = 1020, kLeft = 76, kPanelWidth = 900;

std::string number(const char* format, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string relative_text(const std::optional<RelativeError>& error) {
  if (!error) return "-";
  return number("%.3f %%, ", error->percent) + number("%.5f deg/m", error->deg_per_m);
}

std::string nees_text(const Nees& nees) {
  return number("%.2f", nees.mean) + " on average of " + std::to_string(nees.poses) + " poses, " +
         std::to_string(nees.dof) + " expected; " + number("%.1f %%", 100 * nees.beyond_99) + " beyond " +
         number("%.2f", nees.dof == 3 ? kBeyond99Of3 : kBeyond99Of6) + ", 1 % expected";
}

struct Range {
  double min, max;
};

/// The range of the values with a margin, and never narrower than `least`.
Range range_of(const std::vector<double>& values, double least, double margin) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double middle = (*low + *high) / 2;
  const double half = std::max(*high - *low, least) / 2 * (1 + 2 * margin);
  return {middle - half, middle + half};
}

/// How the picture lays the estimate over the reference.
const Pose& picture_overlay(const Comparison& comparison) {
  return comparison.kidnaps.kidnaps.empty() ? comparison.evaluation.reference_from_estimate
                                            : comparison.kidnaps.reference_from_estimate;
}

bool claims_to_track(const Comparison& comparison, double time_s) {
  if (comparison.states.empty()) return true;
  const auto state = state_at(comparison.states, time_s);
  return state == TrackingState::kTracking || state == TrackingState::kDegraded;
}

/// The reference without lines across the kidnaps.
std::vector<Points2> reference_pieces(const Comparison& comparison) {
  std::vector<Points2> pieces(1);
  auto next = comparison.kidnaps.kidnaps.begin();
  for (std::size_t i = 0; i < comparison.reference.size(); ++i) {
    if (next != comparison.kidnaps.kidnaps.end() && i == next->index) {
      pieces.emplace_back();
      ++next;
    }
    pieces.back().push_back(comparison.reference[i].pose.translation().head<2>());
  }
  return pieces;
}

/// A stretch of the estimate of one kind.
struct Stretch {
  bool tracking;
  Points2 line;
};

std::vector<Stretch> estimate_stretches(const Comparison& comparison) {
  const Pose& overlay = picture_overlay(comparison);
  std::vector<Stretch> stretches;
  for (const StampedPose& stamped : comparison.estimate) {
    const bool tracking = claims_to_track(comparison, stamped.time_s);
    if (stretches.empty() || stretches.back().tracking != tracking) stretches.push_back({tracking, {}});
    stretches.back().line.push_back((overlay * stamped.pose.translation()).head<2>());
  }
  return stretches;
}

std::string kidnap_words(const Kidnap& kidnap) {
  return number("kidnapped %.1f m, ", kidnap.jump_m) + number("%.0f deg; ", kidnap.jump_deg) +
         (kidnap.recovery_s ? number("back after %.1f s", *kidnap.recovery_s) : "not back");
}

std::string kidnaps_from_above(const Comparison& comparison, const SvgPanel& panel) {
  std::string svg;
  for (const Kidnap& kidnap : comparison.kidnaps.kidnaps) {
    const Eigen::Vector2d from = comparison.reference[kidnap.index - 1].pose.translation().head<2>();
    const Eigen::Vector2d to = comparison.reference[kidnap.index].pose.translation().head<2>();
    svg += panel.line({from, to}, "kidnap") + panel.circle(to, "kidnap-end") +
           panel.label(to, kidnap_words(kidnap));
  }
  return svg;
}

std::string seen_from_above(const Comparison& comparison) {
  const std::vector<Points2> reference = reference_pieces(comparison);
  const std::vector<Stretch> estimate = estimate_stretches(comparison);
  std::vector<double> x, y;
  const auto widen = [&](const Points2& points) {
    for (const Eigen::Vector2d& point : points) {
      x.push_back(point.x());
      y.push_back(point.y());
    }
  };
  for (const Points2& piece : reference) widen(piece);
  for (const Stretch& stretch : estimate) widen(stretch.line);
  const Range x_range = range_of(x, 1e-3, 0.04), y_range = range_of(y, 1e-3, 0.04);
  const auto panel = SvgPanel::equal_scales({kLeft, 84, kPanelWidth, 520}, {x_range.min, y_range.min},
                                            {x_range.max, y_range.max});
  const Eigen::Vector2d start = estimate.front().line.front(), end = estimate.back().line.back();
  std::string svg = panel.grid("x (m)", "y (m)", 9, 6);
  for (const Points2& piece : reference) svg += panel.line(piece, "reference");
  for (const Stretch& stretch : estimate)
    svg += panel.line(stretch.line, stretch.tracking ? "estimate" : "lost");
  svg += panel.square(reference.back().back(), "reference-end") + panel.square(end, "estimate-end");
  svg += panel.circle(start, "start");
  const bool loop = (panel.to_pixels(start) - panel.to_pixels(end)).norm() < 60;
  svg += panel.label(start, loop ? "start and end" : "start");
  if (!loop) svg += panel.label(end, "end");
  return svg + kidnaps_from_above(comparison, panel) + panel.scale_bar();
}

std::string over_the_way(const Comparison& comparison) {
  const Pose& overlay = picture_overlay(comparison);
  const std::vector<double> errors = position_errors(comparison.pairs, overlay);
  Points2 reference, estimate, error;
  std::vector<double> heights;
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const PosePair& pair = comparison.pairs[i];
    const double way = pair.way_m - comparison.pairs.front().way_m;
    reference.push_back({way, pair.reference.translation().z()});
    estimate.push_back({way, (overlay * pair.estimate.translation()).z()});
    error.push_back({way, errors[i]});
    heights.push_back(reference.back().y());
    heights.push_back(estimate.back().y());
  }
  const double way = std::max(comparison.evaluation.length_m, 1e-3);
  const Range height = range_of(heights, 0.1, 0.1);
  const double most = std::max(1.1 * *std::max_element(errors.begin(), errors.end()), 1e-3);
  const SvgPanel side({kLeft, 660, kPanelWidth, 120}, {0, height.min}, {way, height.max});
  const SvgPanel below({kLeft, 840, kPanelWidth, 120}, {0, 0}, {way, most});
  std::string svg = side.grid("way (m)", "height z (m)", 9, 4) + side.line(reference, "reference") +
                    side.line(estimate, "estimate") + below.grid("way (m)", "error (m)", 9, 4);
  for (const Kidnap& kidnap : comparison.kidnaps.kidnaps) {
    const auto at = std::find_if(comparison.pairs.begin(), comparison.pairs.end(),
                                 [&](const PosePair& pair) { return pair.time_s >= kidnap.time_s - 1e-3; });
    if (at == comparison.pairs.end()) continue;
    const double x = at->way_m - comparison.pairs.front().way_m;
    svg += below.line({{x, 0}, {x, most}}, "kidnap-line");
  }
  return svg + below.line(error, "error");
}

std::string heading(const Comparison& comparison) {
  const Evaluation& e = comparison.evaluation;
  std::string numbers = std::to_string(e.matched) + " of " + std::to_string(e.poses) +
                        " poses matched over " + number("%.1f m", e.length_m) + "; position error rmse " +
                        number("%.3f m", e.ate_m.rmse) + number(", max %.3f m", e.ate_m.max);
  if (e.rpe[1]) numbers += "; over 10 m " + number("%.2f %%", e.rpe[1]->percent);
  if (e.kitti) numbers += "; KITTI " + number("%.2f %%", e.kitti->percent);
  const auto text = [](const char* css_class, double y, const std::string& content) {
    return "<text class=\"" + std::string(css_class) + "\" x=\"" + number("%.0f", kLeft) + "\" y=\"" +
           number("%.0f", y) + "\">" + escaped(content) + "</text>\n";
  };
  return text("title", 32, comparison.estimate_name + " against " + comparison.reference_name) +
         text("axis", 58, numbers) +
         "<path class=\"estimate\" d=\"M76 72h28\"/><text class=\"tick\" x=\"110\" y=\"76\">estimate</text>\n"
         "<path class=\"reference\" d=\"M186 72h28\"/><text class=\"tick\" x=\"222\" "
         "y=\"76\">reference</text>\n" +
         (comparison.states.empty() ? ""
                                    : "<path class=\"lost\" d=\"M304 72h28\"/><text class=\"tick\" x=\"340\" "
                                      "y=\"76\">estimate, not tracking by its own account</text>\n");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> result_rows(const Comparison& comparison) {
  const Evaluation& evaluation = comparison.evaluation;
  std::vector<std::pair<std::string, std::string>> rows = {
      {"poses", std::to_string(evaluation.poses)},
      {"matched", std::to_string(evaluation.matched)},
      {"length", number("%.3f m", evaluation.length_m)},
      {"ATE rmse", number("%.4f m", evaluation.ate_m.rmse)},
      {"ATE median", number("%.4f m", evaluation.ate_m.median)},
      {"ATE max", number("%.4f m", evaluation.ate_m.max)},
  };
  for (std::size_t i = 0; i < kRelativeLengths.size(); ++i)
    rows.push_back({"RPE over " + number("%.0f m", kRelativeLengths[i]), relative_text(evaluation.rpe[i])});
  rows.push_back({"KITTI 100 to 800 m", relative_text(evaluation.kitti)});
  if (comparison.nees) rows.push_back({"NEES", nees_text(*comparison.nees)});
  for (const Kidnap& kidnap : comparison.kidnaps.kidnaps) {
    const double since_start = kidnap.time_s - comparison.reference.front().time_s;
    rows.push_back({number("at %.1f s", since_start), kidnap_words(kidnap)});
  }
  if (comparison.kidnaps.wrong_jumps)
    rows.push_back({"wrong jumps", std::to_string(*comparison.kidnaps.wrong_jumps)});
  return rows;
}

std::string trajectory_svg(const Comparison& comparison) {
  const std::string size = number("%.0f", kWidth) + " " + number("%.0f", kHeight);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size +
         "\" width=\"1000\" height=\"1020\">\n" + kSvgStyle +
         "<rect width=\"100%\" height=\"100%\" fill=\"#fafafa\"/>\n" + heading(comparison) +
         seen_from_above(comparison) + over_the_way(comparison) + "</svg>\n";
}

std::string trajectory_html(const Comparison& comparison) {
  const std::string title = escaped(comparison.estimate_name + " against " + comparison.reference_name);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" +
                     title +
                     "</title>\n<style>\n"
                     "body { font-family: \"DejaVu Sans\", Verdana, Helvetica, sans-serif; margin: 2em auto; "
                     "max-width: 1000px; color: #202124; }\n"
                     "svg { max-width: 100%; height: auto; }\n"
                     "table { border-collapse: collapse; margin: 1em 76px; }\n"
                     "td { padding: 0.3em 1.2em 0.3em 0; border-bottom: 1px solid #eceff1; }\n"
                     "td + td { font-variant-numeric: tabular-nums; }\n</style>\n</head>\n<body>\n" +
                     trajectory_svg(comparison) + "<table>\n";
  for (const auto& [what, value] : result_rows(comparison))
    html += "<tr><td>" + escaped(what) + "</td><td>" + escaped(value) + "</td></tr>\n";
  return html + "</table>\n</body>\n</html>\n";
}

}  // namespace scanlock
