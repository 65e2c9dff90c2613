// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/map_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

#include "evaluation/svg.hpp"

namespace scanlock {
namespace {

constexpr double kPlanLeft = 76, kPlanTop = 70, kPlanWidth = 890, kPlanHeight = 760;  // pixels
constexpr double kPlanCells = 450;       // cells along the longer side of the plan
constexpr float kStandingLevel = 0.25F;  // metres; points at three consecutive levels are a vertical surface
constexpr std::size_t kListedCorrections = 12,
                      kLongestEvidence = 130;  // corrections, and characters of their evidence

using PlanCell = std::pair<int, int>;

struct PlanExtent {
  Eigen::Vector2d least = Eigen::Vector2d::Constant(1e9), most = Eigen::Vector2d::Constant(-1e9);
  void add(const Eigen::Vector2d& p) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
};

/// The centres of the cells that contain a vertical surface.
Points2 plan_of(const PointCloud& map, double cell) {
  std::map<PlanCell, std::set<int>> levels;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Eigen::Vector3f p = map.point(i);
    const PlanCell at(static_cast<int>(std::floor(static_cast<double>(p.x()) / cell)),
                      static_cast<int>(std::floor(static_cast<double>(p.y()) / cell)));
    levels[at].insert(static_cast<int>(std::floor(p.z() / kStandingLevel)));
  }
  Points2 plan;
  for (const auto& [at, heights] : levels) {
    // A noisy floor occupies two levels, and the ceiling above it others.
    const auto body_ups = [&](int level) {
      return heights.count(level + 1) != 0 && heights.count(level + 2) != 0;
    };
    if (std::any_of(heights.begin(), heights.end(), body_ups))
      plan.push_back(cell * Eigen::Vector2d(at.first + 0.5, at.second + 0.5));
  }
  return plan;
}

std::string line_of_text(double x, double y, const char* css_class, const std::string& words) {
  char head[96];
  std::snprintf(head, sizeof head, "<text class=\"%s\" x=\"%.0f\" y=\"%.0f\">", css_class, x, y);
  return head + escaped(words) + "</text>\n";
}

}  // namespace

std::string map_svg(const MapPicture& picture) {
  PlanExtent extent;
  for (std::size_t i = 0; i < picture.map.size(); ++i)
    extent.add(picture.map.point(i).head<2>().cast<double>());
  for (const auto& way : picture.ways)
    for (const Eigen::Vector3d& p : way) extent.add(p.head<2>());
  if (!((extent.most - extent.least).minCoeff() > 0)) {
    extent.least = Eigen::Vector2d::Constant(-1);
    extent.most = Eigen::Vector2d::Constant(1);
  }
  const Eigen::Vector2d margin = 0.02 * (extent.most - extent.least);
  const SvgPanel panel = SvgPanel::equal_scales({kPlanLeft, kPlanTop, kPlanWidth, kPlanHeight},
                                                extent.least - margin, extent.most + margin);
  const std::size_t listed = std::min(picture.corrections.size(), kListedCorrections);
  char head[160];
  std::snprintf(head, sizeof head,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1000 %.0f\" width=\"1000\">\n",
                kPlanTop + kPlanHeight + 70 + 20 * static_cast<double>(listed));
  std::string svg = head;
  svg +=
      "<style>text { font-family: \"DejaVu Sans\", Verdana, sans-serif; fill: #202124; } .title { font-size: "
      "17px; } .axis, .found { font-size: 13px; } .tick { font-size: 12px; fill: #5f6368; } .panel { fill: "
      "none; stroke: #9aa0a6; } .grid { stroke: #eceff1; fill: none; } .plan { stroke: #6b7280; "
      "stroke-width: "
      "2; stroke-linecap: round; fill: none; } .way { stroke: #1a73e8; stroke-width: 2; fill: none; } .place "
      "{ "
      "fill: #d93025; }</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  svg +=
      line_of_text(kPlanLeft, 32, "title", picture.title) +
      line_of_text(
          kPlanLeft, 54, "axis",
          "grey: upright objects of the map; blue: path of the robot; red: relocalisations and corrections") +
      panel.grid("x (m)", "y (m)", 9, 8) + "<path class=\"plan\" d=\"";
  for (const Eigen::Vector2d& p :
       plan_of(picture.map, (extent.most - extent.least).maxCoeff() / kPlanCells)) {
    const Eigen::Vector2d at = panel.to_pixels(p);
    char dot[40];
    std::snprintf(dot, sizeof dot, "M%.1f %.1fh0", at.x(), at.y());
    svg += dot;
  }
  svg += "\"/>\n";
  for (const auto& way : picture.ways) {
    Points2 line;
    for (const Eigen::Vector3d& p : way) line.push_back(p.head<2>());
    svg += panel.line(line, "way");
  }
  for (std::size_t i = 0; i < picture.corrections.size(); ++i) {
    const MapPicture::Correction& correction = picture.corrections[i];
    svg += panel.circle(correction.position.head<2>(), "place");
    if (i >= listed) continue;
    svg += panel.label(correction.position.head<2>(), std::to_string(i + 1));
    char when[48];
    std::snprintf(when, sizeof when, "%zu  at %.1f s: ", i + 1, correction.time_s);
    std::string evidence = correction.evidence;
    if (evidence.size() > kLongestEvidence) evidence = evidence.substr(0, kLongestEvidence - 3) + "...";
    svg += line_of_text(kPlanLeft, kPlanTop + kPlanHeight + 60 + 20 * static_cast<double>(i), "found",
                        when + evidence);
  }
  return svg + "</svg>\n";
}

}  // namespace scanlock
