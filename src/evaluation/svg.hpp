// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

// The few shapes that our pictures need; coordinates are SVG's, in pixels, y down.
namespace scanlock {

using Points2 = std::vector<Eigen::Vector2d>;

/// The line without the points that lie within `tolerance` of it (Douglas and Peucker); ends are kept.
Points2 simplified(const Points2& line, double tolerance);

/// Steps of 1, 2 or 5 times a power of ten: the largest that gives at least `count` / 2.5 of them over `span`
/// > 0.
double nice_step(double span, int count);

/// A number as short as its step allows: 0.25, 120.
std::string tick_label(double value, double step);

/// Text that may stand in XML.
std::string escaped(const std::string& text);

/// A rectangle of the picture that shows a rectangle of data, y up.
class SvgPanel {
 public:
  struct Frame {
    double left, top, width, height;  ///< pixels
  };
  /// Data ranges must not be empty (min < max).
  SvgPanel(Frame frame, Eigen::Vector2d data_min, Eigen::Vector2d data_max);
  /// The same with equal scales: the data range is widened on one axis and centred.
  static SvgPanel equal_scales(Frame frame, Eigen::Vector2d data_min, Eigen::Vector2d data_max);

  Eigen::Vector2d to_pixels(const Eigen::Vector2d& data) const;
  double pixels_per_unit_x() const { return frame_.width / (max_.x() - min_.x()); }

  /// Frame, grid, tick labels and the titles of both axes.
  std::string grid(const std::string& x_title, const std::string& y_title, int x_ticks, int y_ticks) const;
  /// A line through data points, thinned to what the eye can tell apart. `css_class` names its style.
  std::string line(const Points2& data, const std::string& css_class) const;
  /// A bar of a round length in the lower left corner, with its length in metres.
  std::string scale_bar() const;
  /// A word beside a place.
  std::string label(const Eigen::Vector2d& place, const std::string& text) const;
  std::string circle(const Eigen::Vector2d& place, const std::string& css_class) const;
  std::string square(const Eigen::Vector2d& place, const std::string& css_class) const;

 private:
  Frame frame_;
  Eigen::Vector2d min_, max_;
};

}  // namespace scanlock
