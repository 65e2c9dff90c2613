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
  return number("%.2f %%, ", error->percent) + number("%.4f deg/m", error->deg_per_m);
}

/// Whether the report distinguishes errors of tracked poses from errors of all poses.
bool is_split(const Comparison& comparison) {
  return comparison.split.tracking && comparison.split.tracking->poses < comparison.pairs.size();
}

std::string nees_text(const Nees& nees) {
  return number("%.2f", nees.mean) + " (mean of " + std::to_string(nees.poses) + " poses), " +
         std::to_string(nees.dof) + " expected; " + number("%.1f %%", 100 * nees.beyond_99) + " beyond " +
         number("%.2f", nees.dof == 3 ? kBeyond99Of3 : kBeyond99Of6) + ", 1 % expected";
}

struct Range {
  double min, max;
};

/// The range of the values with a margin; its width without the margin is at least `least`.
Range range_of(const std::vector<double>& values, double least, double margin) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double middle = (*low + *high) / 2;
  const double half = std::max(*high - *low, least) / 2 * (1 + 2 * margin);
  return {middle - half, middle + half};
}

/// The alignment used in the picture: from all tracked poses, because a few poses before a kidnap determine
/// the attitude poorly.
const Pose& picture_overlay(const Comparison& comparison) {
  if (is_split(comparison)) return comparison.split.tracking->reference_from_estimate;
  return comparison.kidnaps.kidnaps.empty() ? comparison.evaluation.reference_from_estimate
                                            : comparison.kidnaps.reference_from_estimate;
}

/// The reference, cut at the kidnaps.
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

/// Consecutive poses of the estimate that are all tracked, or all not tracked.
struct Stretch {
  bool tracking;
  Points2 line;
};

void extend(std::vector<Stretch>& stretches, bool tracking, const Eigen::Vector2d& point) {
  if (stretches.empty() || stretches.back().tracking != tracking) stretches.push_back({tracking, {}});
  stretches.back().line.push_back(point);
}

std::string lines(const std::vector<Stretch>& stretches, const SvgPanel& panel) {
  std::string svg;
  for (const Stretch& stretch : stretches)
    svg += panel.line(stretch.line, stretch.tracking ? "estimate" : "lost");
  return svg;
}

std::vector<Stretch> estimate_stretches(const Comparison& comparison) {
  const Pose& overlay = picture_overlay(comparison);
  std::vector<Stretch> stretches;
  for (const StampedPose& stamped : comparison.estimate)
    extend(stretches, claims_to_track(comparison.states, stamped.time_s),
           (overlay * stamped.pose.translation()).head<2>());
  return stretches;
}

std::string kidnap_words(const Kidnap& kidnap) {
  return number("kidnapped %.1f m, ", kidnap.jump_m) + number("%.0f deg; ", kidnap.jump_deg) +
         (kidnap.recovery_s ? number("recovered after %.1f s", *kidnap.recovery_s) : "not recovered");
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
  svg += lines(estimate, panel);
  svg += panel.square(reference.back().back(), "reference-end") + panel.square(end, "estimate-end");
  svg += panel.circle(start, "start");
  const bool loop = (panel.to_pixels(start) - panel.to_pixels(end)).norm() < 60;
  svg += panel.label(start, loop ? "start and end" : "start");
  if (!loop) svg += panel.label(end, "end");
  return svg + kidnaps_from_above(comparison, panel) + panel.scale_bar();
}

std::string height_over_the_way(const Comparison& comparison) {
  const Pose& overlay = picture_overlay(comparison);
  Points2 reference;
  std::vector<Stretch> estimate;
  std::vector<double> heights;
  for (const PosePair& pair : comparison.pairs) {
    const double way = pair.way_m - comparison.pairs.front().way_m;
    reference.push_back({way, pair.reference.translation().z()});
    extend(estimate, claims_to_track(comparison.states, pair.time_s),
           {way, (overlay * pair.estimate.translation()).z()});
    heights.push_back(reference.back().y());
    heights.push_back(estimate.back().line.back().y());
  }
  const double way = std::max(comparison.evaluation.length_m, 1e-3);
  const Range height = range_of(heights, 0.1, 0.1);
  const SvgPanel side({kLeft, 660, kPanelWidth, 120}, {0, height.min}, {way, height.max});
  return side.grid("distance (m)", "height z (m)", 9, 4) + side.line(reference, "reference") +
         lines(estimate, side);
}

/// The errors of the tracked poses, in connected pieces; of all poses when they are not split.
std::vector<Points2> error_pieces(const Comparison& comparison) {
  const bool split = is_split(comparison);
  const std::vector<double> errors = position_errors(comparison.pairs, picture_overlay(comparison));
  std::vector<Points2> pieces;
  bool joined = false;  // with the previous pair
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const bool shown = !split || comparison.split.tracked[i] != 0;
    if (shown && !joined) pieces.emplace_back();
    if (shown)
      pieces.back().push_back({comparison.pairs[i].way_m - comparison.pairs.front().way_m, errors[i]});
    joined = shown;
  }
  return pieces;
}

std::string error_over_the_way(const Comparison& comparison) {
  const std::vector<Points2> pieces = error_pieces(comparison);
  double most = 1e-3;
  for (const Points2& piece : pieces)
    for (const Eigen::Vector2d& point : piece) most = std::max(most, 1.1 * point.y());
  const double way = std::max(comparison.evaluation.length_m, 1e-3);
  const SvgPanel below({kLeft, 840, kPanelWidth, 120}, {0, 0}, {way, most});
  std::string svg =
      below.grid("distance (m)", is_split(comparison) ? "error, tracking (m)" : "error (m)", 9, 4);
  for (const Kidnap& kidnap : comparison.kidnaps.kidnaps) {
    const auto at = std::find_if(comparison.pairs.begin(), comparison.pairs.end(),
                                 [&](const PosePair& pair) { return pair.time_s >= kidnap.time_s - 1e-3; });
    if (at == comparison.pairs.end()) continue;
    const double x = at->way_m - comparison.pairs.front().way_m;
    svg += below.line({{x, 0}, {x, most}}, "kidnap-line");
  }
  for (const Points2& piece : pieces) svg += below.line(piece, "error");
  return svg;
}

std::string heading(const Comparison& comparison) {
  const Evaluation& e = comparison.evaluation;
  std::string numbers = std::to_string(e.matched) + " of " + std::to_string(e.poses) +
                        " poses matched over " + number("%.1f m", e.length_m) + "; position error ";
  const bool split = is_split(comparison);
  const AbsoluteError& ate_m = split ? comparison.split.tracking->ate_m : e.ate_m;
  const auto& over_10_m = split ? comparison.split.tracking->rpe[1] : e.rpe[1];
  numbers += (split ? "while tracking: rmse " : "rmse ") + number("%.3f m", ate_m.rmse) +
             number(", max %.3f m", ate_m.max);
  if (over_10_m) numbers += "; over 10 m " + number("%.2f %%", over_10_m->percent);
  if (e.kitti && !split) numbers += "; KITTI " + number("%.2f %%", e.kitti->percent);
  const auto text = [](const char* css_class, double y, const std::string& content) {
    return "<text class=\"" + std::string(css_class) + "\" x=\"" + number("%.0f", kLeft) + "\" y=\"" +
           number("%.0f", y) + "\">" + escaped(content) + "</text>\n";
  };
  return text("title", 32, comparison.estimate_name + " against " + comparison.reference_name) +
         text("axis", 58, numbers) +
         "<path class=\"estimate\" d=\"M76 72h28\"/><text class=\"tick\" x=\"110\" y=\"76\">estimate</text>\n"
         "<path class=\"reference\" d=\"M186 72h28\"/><text class=\"tick\" x=\"222\" "
         "y=\"76\">reference</text>\n" +
         (comparison.states.empty()
              ? ""
              : "<path class=\"lost\" d=\"M304 72h28\"/><text class=\"tick\" x=\"340\" "
                "y=\"76\">estimate in other states than TRACKING and DEGRADED</text>\n");
}

void add_errors(const AbsoluteError& ate_m,
                const std::array<std::optional<RelativeError>, kRelativeLengths.size()>& rpe,
                const std::string& indent, Rows& rows) {
  rows.push_back({indent + "ATE rmse", number("%.3f m", ate_m.rmse)});
  rows.push_back({indent + "ATE median", number("%.3f m", ate_m.median)});
  rows.push_back({indent + "ATE max", number("%.3f m", ate_m.max)});
  for (std::size_t i = 0; i < kRelativeLengths.size(); ++i)
    rows.push_back({indent + "RPE over " + number("%.0f m", kRelativeLengths[i]), relative_text(rpe[i])});
}

void add_kidnaps(const Comparison& comparison, Rows& rows) {
  for (std::size_t i = 0; i < comparison.kidnaps.kidnaps.size(); ++i) {
    const Kidnap& kidnap = comparison.kidnaps.kidnaps[i];
    const double since_start = kidnap.time_s - comparison.reference.front().time_s;
    rows.push_back({number("at %.1f s", since_start), kidnap_words(kidnap)});
    if (i >= comparison.split.away.size() || !comparison.split.away[i].ate_m) continue;
    const AwayError& away = comparison.split.away[i];
    rows.push_back({"  until recovery", std::to_string(away.poses) + " poses, " +
                                            number("rmse %.2f m, ", away.ate_m->rmse) +
                                            number("max %.2f m", away.ate_m->max)});
  }
}

}  // namespace

Rows result_rows(const Comparison& comparison) {
  const Evaluation& evaluation = comparison.evaluation;
  Rows rows = {
      {"poses", std::to_string(evaluation.poses)},
      {"matched", std::to_string(evaluation.matched)},
      {"length", number("%.1f m", evaluation.length_m)},
  };
  const bool split = is_split(comparison);
  if (split) {
    const TrackingError& tracking = *comparison.split.tracking;
    rows.push_back({"while tracking", std::to_string(tracking.poses) + " poses"});
    add_errors(tracking.ate_m, tracking.rpe, "  ", rows);
  }
  add_kidnaps(comparison, rows);
  if (split) rows.push_back({"all poses", std::to_string(evaluation.matched) + " poses"});
  add_errors(evaluation.ate_m, evaluation.rpe, split ? "  " : "", rows);
  rows.push_back({std::string(split ? "  " : "") + "KITTI 100 to 800 m", relative_text(evaluation.kitti)});
  if (comparison.nees) rows.push_back({"NEES", nees_text(*comparison.nees)});
  if (comparison.kidnaps.wrong_jumps)
    rows.push_back({"wrong jumps", std::to_string(*comparison.kidnaps.wrong_jumps)});
  rows.insert(rows.end(), comparison.notes.begin(), comparison.notes.end());
  return rows;
}

std::string trajectory_svg(const Comparison& comparison) {
  const std::string size = number("%.0f", kWidth) + " " + number("%.0f", kHeight);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size +
         "\" width=\"1000\" height=\"1020\">\n" + kSvgStyle +
         "<rect width=\"100%\" height=\"100%\" fill=\"#fafafa\"/>\n" + heading(comparison) +
         seen_from_above(comparison) + height_over_the_way(comparison) + error_over_the_way(comparison) +
         "</svg>\n";
}

std::string trajectory_html(const Comparison& comparison) {
  const std::string title = escaped(comparison.estimate_name + " against " + comparison.reference_name);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + title +
      "</title>\n<style>\n"
      "body { font-family: \"DejaVu Sans\", Verdana, Helvetica, sans-serif; margin: 2em; "
      "color: #202124; display: flex; flex-wrap: wrap; gap: 2em; align-items: flex-start; }\n"
      "svg { flex: 1 1 600px; max-width: 1000px; height: auto; }\n"
      "table { flex: 1 1 400px; max-width: 700px; border-collapse: collapse; }\n"
      "td { padding: 0.3em 1.2em 0.3em 0; border-bottom: 1px solid #eceff1; vertical-align: top; "
      "white-space: pre; }\n"
      "td + td { font-variant-numeric: tabular-nums; white-space: normal; }\n"
      "</style>\n</head>\n<body>\n" +
      trajectory_svg(comparison) + "<table>\n";
  for (const auto& [what, value] : result_rows(comparison))
    html += "<tr><td>" + escaped(what) + "</td><td>" + escaped(value) + "</td></tr>\n";
  return html + "</table>\n</body>\n</html>\n";
}

}  // namespace scanlock
