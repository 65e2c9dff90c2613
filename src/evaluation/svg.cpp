// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <utility>

namespace scanlock {
namespace {

constexpr double kLineTolerance = 0.2;  // pixels

__attribute__((format(printf, 1, 2))) std::string printed(const char* format, ...) {
  std::array<char, 512> buffer{};
  va_list arguments;
  va_start(arguments, format);
  const int size = std::vsnprintf(buffer.data(), buffer.size(), format, arguments);
  va_end(arguments);
  return std::string(buffer.data(), static_cast<std::size_t>(std::clamp(size, 0, 511)));
}

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double along = ab.squaredNorm() > 0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
  return (a + along * ab - p).norm();
}

}  // namespace

Points2 simplified(const Points2& line, double tolerance) {
  if (line.size() < 3) return line;
  std::vector<bool> keep(line.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, line.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    std::size_t farthest = first;
    double distance = tolerance;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d = distance_to_segment(line[i], line[first], line[last]);
      if (d > distance) {
        distance = d;
        farthest = i;
      }
    }
    if (farthest == first) continue;
    keep[farthest] = true;
    open.push_back({first, farthest});
    open.push_back({farthest, last});
  }
  Points2 kept;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (keep[i]) kept.push_back(line[i]);
  return kept;
}

double nice_step(double span, int count) {
  const double rough = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

std::string tick_label(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return printed("%.*f", decimals, std::abs(value) < step / 2 ? 0.0 : value);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result;
}

SvgPanel::SvgPanel(Frame frame, Eigen::Vector2d data_min, Eigen::Vector2d data_max)
    : frame_(frame), min_(data_min), max_(data_max) {}

SvgPanel SvgPanel::equal_scales(Frame frame, Eigen::Vector2d data_min, Eigen::Vector2d data_max) {
  const Eigen::Vector2d span = data_max - data_min, centre = (data_min + data_max) / 2;
  const double unit = std::max(span.x() / frame.width, span.y() / frame.height);  // data units per pixel
  const Eigen::Vector2d half = unit / 2 * Eigen::Vector2d(frame.width, frame.height);
  return SvgPanel(frame, centre - half, centre + half);
}

Eigen::Vector2d SvgPanel::to_pixels(const Eigen::Vector2d& data) const {
  const Eigen::Vector2d part = (data - min_).cwiseQuotient(max_ - min_);
  return {frame_.left + part.x() * frame_.width, frame_.top + (1 - part.y()) * frame_.height};
}

std::string SvgPanel::grid(const std::string& x_title, const std::string& y_title, int x_ticks,
                           int y_ticks) const {
  const double right = frame_.left + frame_.width, bottom = frame_.top + frame_.height;
  std::string svg = printed("<rect class=\"panel\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
                            frame_.left, frame_.top, frame_.width, frame_.height);
  const double x_step = nice_step(max_.x() - min_.x(), x_ticks);
  for (double k = std::ceil(min_.x() / x_step); k * x_step <= max_.x(); ++k) {
    const double x = to_pixels({k * x_step, min_.y()}).x();
    svg += printed("<path class=\"grid\" d=\"M%.1f %.1fV%.1f\"/>", x, frame_.top, bottom);
    svg += printed("<text class=\"tick\" text-anchor=\"middle\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", x,
                   bottom + 15, tick_label(k * x_step, x_step).c_str());
  }
  const double y_step = nice_step(max_.y() - min_.y(), y_ticks);
  for (double k = std::ceil(min_.y() / y_step); k * y_step <= max_.y(); ++k) {
    const double y = to_pixels({min_.x(), k * y_step}).y();
    svg += printed("<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/>", frame_.left, y, right);
    svg += printed("<text class=\"tick\" text-anchor=\"end\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
                   frame_.left - 6, y + 4, tick_label(k * y_step, y_step).c_str());
  }
  svg += printed("<text class=\"axis\" text-anchor=\"middle\" x=\"%.1f\" y=\"%.1f\">",
                 (frame_.left + right) / 2, bottom + 32) +
         escaped(x_title) + "</text>\n";
  const double y_middle = (frame_.top + bottom) / 2;
  svg +=
      printed("<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(%.1f %.1f) rotate(-90)\">",
              frame_.left - 50, y_middle) +
      escaped(y_title) + "</text>\n";
  return svg;
}

std::string SvgPanel::line(const Points2& data, const std::string& css_class) const {
  Points2 pixels;
  for (const Eigen::Vector2d& point : data) pixels.push_back(to_pixels(point));
  std::string svg = "<path class=\"" + css_class + "\" d=\"";
  char command = 'M';
  for (const Eigen::Vector2d& p : simplified(pixels, kLineTolerance)) {
    svg += printed("%c%.1f %.1f", command, p.x(), p.y());
    command = 'L';
  }
  return svg + "\"/>\n";
}

std::string SvgPanel::scale_bar() const {
  const double metres = nice_step((max_.x() - min_.x()) / 5, 2);
  const double pixels = metres * pixels_per_unit_x();
  const double x = frame_.left + 16, y = frame_.top + frame_.height - 16;
  return printed("<path class=\"bar\" d=\"M%.1f %.1fv8h%.1fv-8\"/>", x, y - 4, pixels) +
         printed("<text class=\"tick halo\" text-anchor=\"middle\" x=\"%.1f\" y=\"%.1f\">", x + pixels / 2,
                 y - 6) +
         tick_label(metres, metres) + " m</text>\n";
}

std::string SvgPanel::label(const Eigen::Vector2d& place, const std::string& text) const {
  const Eigen::Vector2d p = to_pixels(place);
  constexpr double kCharacter = 7;  // pixels, approximately
  const double width = 10 + kCharacter * static_cast<double>(text.size());
  const bool at_the_right = p.x() + width > frame_.left + frame_.width;
  return printed("<text class=\"axis halo\" text-anchor=\"%s\" x=\"%.1f\" y=\"%.1f\">",
                 at_the_right ? "end" : "start", p.x() + (at_the_right ? -10 : 10), p.y() - 8) +
         escaped(text) + "</text>\n";
}

std::string SvgPanel::circle(const Eigen::Vector2d& place, const std::string& css_class) const {
  const Eigen::Vector2d p = to_pixels(place);
  return "<circle class=\"" + css_class + printed("\" cx=\"%.1f\" cy=\"%.1f\" r=\"8\"/>\n", p.x(), p.y());
}

std::string SvgPanel::square(const Eigen::Vector2d& place, const std::string& css_class) const {
  const Eigen::Vector2d p = to_pixels(place);
  return "<rect class=\"" + css_class +
         printed("\" x=\"%.1f\" y=\"%.1f\" width=\"10\" height=\"10\"/>\n", p.x() - 5, p.y() - 5);
}

}  // namespace scanlock
