// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/alignment_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "evaluation/svg.hpp"
#include "search/kd_tree.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kDrawn = 4000;  // of each cloud, about
constexpr double kPanel = 420, kGap = 60, kTop = 60;
constexpr int kColours = 6;
constexpr std::array<const char*, kColours> kPalette = {"#30123b", "#3e7bf5", "#1ae4b6",
                                                        "#a4fc3c", "#fb8022", "#c1121f"};

struct View {
  const char *name, *across, *up;
  int a, b;  // indices of the coordinates drawn
};
constexpr std::array<View, 3> kViews = {{{"from above", "x, m", "y, m", 0, 1},
                                         {"from the side", "x, m", "z, m", 0, 2},
                                         {"from the front", "y, m", "z, m", 1, 2}}};

struct Dots {
  std::vector<Eigen::Vector3d> points;
  std::vector<int> colours;  ///< empty for the target
};

Dots drawn(const PointCloud& cloud) {
  Dots dots;
  const std::size_t stride = std::max<std::size_t>(1, cloud.size() / kDrawn);
  for (std::size_t i = 0; i < cloud.size(); i += stride) {
    if (cloud.point(i).allFinite()) dots.points.push_back(cloud.point(i).cast<double>());
  }
  return dots;
}

std::vector<double> distances(const Dots& dots, const KdTree& tree, const Eigen::Vector3d& origin) {
  std::vector<double> result;
  for (const Eigen::Vector3d& p : dots.points)
    result.push_back(
        std::sqrt(static_cast<double>(tree.nearest((p - origin).cast<float>()).squared_distance)));
  return result;
}

/// The central 98 % of one coordinate of target and source, with a margin.
std::pair<double, double> extent(const Dots& target, const Dots& source, int coordinate) {
  std::vector<double> values;
  for (const Dots* dots : {&target, &source}) {
    for (const Eigen::Vector3d& p : dots->points) values.push_back(p[coordinate]);
  }
  if (values.empty()) return {0, 1};
  std::sort(values.begin(), values.end());
  const double low = values[values.size() / 100], high = values[values.size() - 1 - values.size() / 100];
  const double margin = 0.05 * (high - low) + 1e-6 * std::max(1.0, std::abs(high));
  return {low - margin, high + margin};
}

std::string dot(const Eigen::Vector2d& at, const char* colour, double radius) {
  char text[96];
  std::snprintf(text, sizeof text, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\"/>\n", at.x(),
                at.y(), radius, colour);
  return text;
}

std::string panel(const View& view, SvgPanel::Frame frame, const Dots& source, const Dots& target) {
  const auto [a0, a1] = extent(target, source, view.a);
  const auto [b0, b1] = extent(target, source, view.b);
  const SvgPanel axes = SvgPanel::equal_scales(frame, {a0, b0}, {a1, b1});
  // One path per colour: each point is a line of zero length with round ends.
  std::array<std::string, kColours + 1> paths;
  const auto draw = [&](const Eigen::Vector3d& p, std::size_t colour) {
    const Eigen::Vector2d at = axes.to_pixels({p[view.a], p[view.b]});
    const bool inside = at.x() >= frame.left && at.x() <= frame.left + frame.width && at.y() >= frame.top &&
                        at.y() <= frame.top + frame.height;
    char command[48];
    std::snprintf(command, sizeof command, "M%.1f %.1fh0", at.x(), at.y());
    if (inside) paths[colour] += command;
  };
  for (const Eigen::Vector3d& p : target.points) draw(p, kColours);
  for (std::size_t i = 0; i < source.points.size(); ++i)
    draw(source.points[i], static_cast<std::size_t>(source.colours[i]));
  std::string svg = axes.grid(view.across, view.up, 5, 5);
  for (std::size_t k = 0; k <= kColours; ++k) {
    const std::size_t colour = (k + kColours) % (kColours + 1);  // the target first, below the source
    if (paths[colour].empty()) continue;
    svg += std::string("<path class=\"dots\" stroke=\"") +
           (colour == kColours ? "#b8b8b8" : kPalette[colour]) + "\" d=\"" + paths[colour] + "\"/>\n";
  }
  return svg;
}

std::string text(double x, double y, const std::string& words, const char* colour = "#222") {
  char head[128];
  std::snprintf(head, sizeof head, "<text x=\"%.0f\" y=\"%.0f\" font-size=\"14\" fill=\"%s\">", x, y, colour);
  return head + escaped(words) + "</text>\n";
}

/// Each colour class is twice as wide as the one before; the first ends at `unit` metres.
int colour_of(double distance, double unit) {
  if (!(distance > unit)) return 0;
  return std::min(kColours - 1, 1 + static_cast<int>(std::log2(distance / unit)));
}

std::string legend(double unit, double y) {
  std::string svg = text(20, y, "distance to the target, m:");
  for (int c = 0; c < kColours; ++c) {
    char words[32];
    const bool last = c + 1 == kColours;
    std::snprintf(words, sizeof words, last ? "> %.3g" : "< %.3g", unit * std::exp2(last ? c - 1 : c));
    svg += dot({220.0 + 110 * c, y - 5}, kPalette[static_cast<std::size_t>(c)], 5) +
           text(230.0 + 110 * c, y, words);
  }
  return svg;
}

}  // namespace

std::string alignment_svg(const AlignmentPicture& picture) {
  const Dots target = drawn(picture.target);
  Dots before = drawn(picture.before), after = drawn(picture.after);
  const Eigen::Vector3d origin = target.points.empty() ? Eigen::Vector3d::Zero() : target.points.front();
  PointCloud local;
  for (std::size_t i = 0; i < picture.target.size(); ++i)
    local.push_back(Eigen::Vector3f((picture.target.point(i).cast<double>() - origin).cast<float>()));
  const KdTree tree(local);
  const std::vector<double> apart_before = distances(before, tree, origin),
                            apart = distances(after, tree, origin);
  std::vector<double> sorted = apart;
  std::sort(sorted.begin(), sorted.end());
  const double unit = std::max(sorted.empty() ? 1.0 : sorted[sorted.size() / 2], 1e-9);
  for (double d : apart_before) before.colours.push_back(colour_of(d, unit));
  for (double d : apart) after.colours.push_back(colour_of(d, unit));

  const double width = 3 * (kPanel + kGap) + kGap, height = 2 * (kPanel + kGap) + kTop + 40;
  char head[256];
  std::snprintf(
      head, sizeof head,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" font-family=\"sans-serif\" "
      "font-size=\"11\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      width, height);
  std::string svg = head;
  svg +=
      "<style>.grid{stroke:#ddd;stroke-width:1;fill:none}.panel{stroke:#888;fill:none}"
      ".dots{stroke-width:1.6;stroke-linecap:round;fill:none}</style>\n";
  svg += text(20, 24,
              picture.title + ": source over target (grey); above: before the alignment, below: after it");
  for (int row = 0; row < 2; ++row) {
    const double top = kTop + row * (kPanel + kGap);
    for (std::size_t v = 0; v < kViews.size(); ++v) {
      const double left = kGap + static_cast<double>(v) * (kPanel + kGap);
      svg += text(left, top - 8, kViews[v].name);
      svg += panel(kViews[v], {left, top, kPanel, kPanel}, row == 0 ? before : after, target);
    }
  }
  return svg + legend(unit, height - 14) + "</svg>\n";
}

}  // namespace scanlock
