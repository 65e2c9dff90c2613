// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

// The few shapes that scanlock's pictures need; coordinates are SVG's: pixels, y down.
namespace scanlock {

using Points2 = std::vector<Eigen::Vector2d>;

/// Removes the points that lie within `tolerance` of the simplified line (Douglas and Peucker); keeps the
/// ends.
Points2 simplified(const Points2& line, double tolerance);

/// The smallest step of 1, 2 or 5 times a power of ten with at most `count` steps in `span`, which must be >
/// 0.
double nice_step(double span, int count);

/// The value with as many decimals as `step` needs: 0.25, 120.
std::string tick_label(double value, double step);

/// Text with the special characters of XML escaped.
std::string escaped(const std::string& text);

/// A rectangle of the picture that shows a rectangle of the data, y up.
class SvgPanel {
 public:
  struct Frame {
    double left, top, width, height;  ///< pixels
  };
  /// Data ranges must not be empty (min < max).
  SvgPanel(Frame frame, Eigen::Vector2d data_min, Eigen::Vector2d data_max);
  /// A panel with equal scales: the data range is widened along one axis and stays centred.
  static SvgPanel equal_scales(Frame frame, Eigen::Vector2d data_min, Eigen::Vector2d data_max);

  Eigen::Vector2d to_pixels(const Eigen::Vector2d& data) const;
  double pixels_per_unit_x() const { return frame_.width / (max_.x() - min_.x()); }

  /// Frame, grid, tick labels and the titles of both axes.
  std::string grid(const std::string& x_title, const std::string& y_title, int x_ticks, int y_ticks) const;
  /// A line through data points, simplified to visible detail. `css_class` names its style.
  std::string line(const Points2& data, const std::string& css_class) const;
  /// A bar of a round length, labelled in metres, in the lower left corner.
  std::string scale_bar() const;
  /// A text beside a position.
  std::string label(const Eigen::Vector2d& place, const std::string& text) const;
  std::string circle(const Eigen::Vector2d& place, const std::string& css_class) const;
  std::string square(const Eigen::Vector2d& place, const std::string& css_class) const;

 private:
  Frame frame_;
  Eigen::Vector2d min_, max_;
};

}  // namespace scanlock
