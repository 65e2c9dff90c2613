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

std::string seen_from_above(const Comparison& comparison) {
  const Pose& overlay = comparison.evaluation.reference_from_estimate;
  Points2 reference, estimate;
  std::vector<double> x, y;
  for (const StampedPose& stamped : comparison.reference)
    reference.push_back(stamped.pose.translation().head<2>());
  for (const StampedPose& stamped : comparison.estimate)
    estimate.push_back((overlay * stamped.pose.translation()).head<2>());
  for (const Points2* points : {&reference, &estimate}) {
    for (const Eigen::Vector2d& point : *points) {
      x.push_back(point.x());
      y.push_back(point.y());
    }
  }
  const Range x_range = range_of(x, 1e-3, 0.04), y_range = range_of(y, 1e-3, 0.04);
  const auto panel = SvgPanel::equal_scales({kLeft, 84, kPanelWidth, 520}, {x_range.min, y_range.min},
                                            {x_range.max, y_range.max});
  std::string svg = panel.grid("x (m)", "y (m)", 9, 6);
  svg += panel.line(reference, "reference") + panel.line(estimate, "estimate");
  svg += panel.square(reference.back(), "reference-end") + panel.square(estimate.back(), "estimate-end");
  svg += panel.circle(estimate.front(), "start");
  const bool loop = (panel.to_pixels(estimate.front()) - panel.to_pixels(estimate.back())).norm() < 60;
  svg += panel.label(estimate.front(), loop ? "start and end" : "start");
  if (!loop) svg += panel.label(estimate.back(), "end");
  return svg + panel.scale_bar();
}

std::string over_the_way(const Comparison& comparison) {
  const Pose& overlay = comparison.evaluation.reference_from_estimate;
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
  const SvgPanel side({kLeft, 660, kPanelWidth, 120}, {0, height.min}, {way, height.max});
  const SvgPanel below({kLeft, 840, kPanelWidth, 120}, {0, 0},
                       {way, std::max(1.1 * comparison.evaluation.ate_m.max, 1e-3)});
  return side.grid("way (m)", "height z (m)", 9, 4) + side.line(reference, "reference") +
         side.line(estimate, "estimate") + below.grid("way (m)", "error (m)", 9, 4) +
         below.line(error, "error");
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
         "y=\"76\">reference</text>\n";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> result_rows(const Evaluation& evaluation) {
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
  for (const auto& [what, value] : result_rows(comparison.evaluation))
    html += "<tr><td>" + escaped(what) + "</td><td>" + escaped(value) + "</td></tr>\n";
  return html + "</table>\n</body>\n</html>\n";
}

}  // namespace scanlock
