// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "simulation/random.hpp"

namespace scanlock {
namespace {

constexpr double kKnot = 0.05;   // seconds between knots
constexpr double kMargin = 1.0;  // seconds for which the motion is defined before its start and after its end
constexpr double kMinimumKidnap = 3, kMaximumKidnap = 15;  // metres in a straight line

double knot_time(std::size_t i) {
  return kKnot * static_cast<double>(i) - kMargin;
}

/// Moving average over 2 half + 1 knots; beyond its ends the series is constant.
std::vector<double> moving_average(const std::vector<double>& in, int half) {
  const int n = static_cast<int>(in.size());
  std::vector<double> out(in.size());
  for (int k = 0; k < n; ++k) {
    double sum = 0;
    for (int j = -half; j <= half; ++j) sum += in[std::clamp(k + j, 0, n - 1)];
    out[k] = sum / (2 * half + 1);
  }
  return out;
}

/// Desired speed at each step of the route, from cruising speed, bends and stops, before accelerations are
/// limited.
struct SpeedPlan {
  double step;
  std::vector<double> limit;  // m/s
  std::vector<double> dwell;  // seconds of standstill
};

SpeedPlan plan_speeds(const Polyline& route, const DriveStyle& style, Random& random) {
  SpeedPlan plan;
  const auto count = static_cast<std::size_t>(std::max(8.0, std::ceil(route.length() / 0.25)));
  plan.step = route.length() / static_cast<double>(count);
  plan.limit.resize(count + 1);
  plan.dwell.assign(count + 1, 0);
  double cruise = style.fast_mps, change_at = 0;
  double stop_at = style.stop_every_m > 0 ? style.stop_every_m * random.uniform(0.5, 1.5) : HUGE_VAL;
  for (std::size_t i = 0; i <= count; ++i) {
    const double s = plan.step * static_cast<double>(i);
    if (s >= change_at) {
      cruise = random.uniform(style.slow_mps, style.fast_mps);
      change_at = s + cruise * random.uniform(4, 12);
    }
    const double bend = std::abs(route.curvature(s)) + 1e-6;
    plan.limit[i] = std::min({cruise, style.yaw_rate / bend, std::sqrt(style.lateral / bend)});
    if (s >= stop_at) {
      plan.limit[i] = 0;
      plan.dwell[i] = random.uniform(2, 6);
      stop_at = s + style.stop_every_m * random.uniform(0.5, 1.5);
    }
  }
  plan.limit.front() = style.start_mps;
  plan.limit.back() = 0;
  if (style.start_mps == 0) plan.dwell.front() = 0.5;
  return plan;
}

/// The speed plan with limited acceleration.
SpeedPlan plan_drive(const Polyline& route, const DriveStyle& style, Random& random) {
  SpeedPlan plan = plan_speeds(route, style, random);
  std::vector<double>& v = plan.limit;
  for (std::size_t i = 1; i < v.size(); ++i)
    v[i] = std::min(v[i], std::sqrt(v[i - 1] * v[i - 1] + 2 * style.accelerate * plan.step));
  for (std::size_t i = v.size() - 1; i-- > 0;)
    v[i] = std::min(v[i], std::sqrt(v[i + 1] * v[i + 1] + 2 * style.brake * plan.step));
  // If the start speed exceeds the limits that follow, the carrier brakes with style.brake until it meets
  // them.
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double left =
        style.start_mps * style.start_mps - 2 * style.brake * plan.step * static_cast<double>(i);
    if (left <= v[i] * v[i]) break;
    v[i] = std::sqrt(left);
    plan.dwell[i] = 0;
  }
  return plan;
}

/// Seconds from leaving step i of the route to reaching step i + 1.
double travel_time(const SpeedPlan& plan, std::size_t i) {
  return 2 * plan.step / std::max(1e-9, plan.limit[i] + plan.limit[i + 1]);
}

/// Arc length at each knot, metres: as planned, then smoothed in time, which also limits jerk.
std::vector<double> drive_distances(const Polyline& route, const DriveStyle& style, double seconds,
                                    Random& random) {
  const SpeedPlan plan = plan_drive(route, style, random);
  const std::vector<double>& v = plan.limit;
  const auto knots = static_cast<std::size_t>(std::ceil((seconds + 2 * kMargin) / kKnot)) + 4;
  std::vector<double> distance(knots, 0);
  double clock = plan.dwell[0];  // time at which step i is left
  std::size_t i = 0;
  for (std::size_t k = 0; k < knots; ++k) {
    const double t = std::max(0.0, knot_time(k));
    while (i + 1 < v.size()) {
      const double travel = travel_time(plan, i);
      if (t < clock + travel + plan.dwell[i + 1]) break;
      clock += travel + plan.dwell[i + 1];
      ++i;
    }
    double s = plan.step * static_cast<double>(i);
    if (i + 1 < v.size() && t > clock) {
      const double travel = travel_time(plan, i);
      const double elapsed = std::min(t - clock, travel);
      s += elapsed * (v[i] + (v[i + 1] - v[i]) * elapsed / (2 * travel));
    }
    // Before t = 0 the carrier moves at its start speed.
    distance[k] = kMargin * style.start_mps + (knot_time(k) < 0 ? knot_time(k) * style.start_mps : s);
  }
  for (int pass = 0; pass < 3; ++pass) distance = moving_average(distance, 3);
  return distance;
}

/// A sum of sinusoids with root mean square 1: the oscillation of the carrier's suspension.
class Springs {
 public:
  Springs(const DriveStyle& style, Random& random) {
    for (Wave& wave : waves_) {
      wave.rate = 2 * kPi * random.uniform(style.slowest_hz, style.fastest_hz);
      wave.phase = random.uniform(0, 2 * kPi);
    }
  }
  double at(double t) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += sin(wave.rate * t + wave.phase);
    return sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
  }

 private:
  struct Wave {
    double rate, phase;
  };
  std::array<Wave, 5> waves_;
};

/// 1 within the event, 0 outside, with smooth ramps of up to 0.3 s inside it.
double envelope(const SimulationEvent& event, double t) {
  const double ramp = std::min(0.3, event.duration_s / 2);
  const double x = std::clamp(std::min(t - event.time_s, event.end_s() - t) / ramp, 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

/// Roll, pitch and yaw of a sensor shaken by hand: about 10 degrees, up to some 150 degrees per second.
Eigen::Vector3d shaking(const std::vector<SimulationEvent>& events, double t) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SimulationEvent& event : events) {
    if (event.kind != EventKind::kShake) continue;
    const double strength = envelope(event, t), u = 2 * kPi * (t - event.time_s);
    sum += strength * Eigen::Vector3d(0.12 * sin(1.9 * u) + 0.05 * sin(3.1 * u + 1),
                                      0.10 * sin(2.3 * u + 2) + 0.04 * sin(3.7 * u),
                                      0.18 * sin(1.4 * u + 1) + 0.06 * sin(2.9 * u + 3));
  }
  return sum;
}

/// Computes control points of the pose spline from route, distances and ground.
class PoseMaker {
 public:
  PoseMaker(const Polyline& route, const Terrain& terrain, const DriveStyle& style,
            const std::vector<SimulationEvent>& events, const std::vector<double>& distance, Random& random)
      : route_(route),
        terrain_(terrain),
        style_(style),
        events_(events),
        distance_(distance),
        roll_(style, random),
        pitch_(style, random),
        heave_(style, random) {}

  /// The control points of the drive, `back` metres behind on the route and turned by `turn` radians.
  std::vector<Vector6> controls(double back, double turn) const {
    const Footing footing = stand(back, turn);
    std::vector<Vector6> controls;
    controls.reserve(distance_.size());
    for (std::size_t k = 0; k < distance_.size(); ++k) controls.push_back(control(k, back, turn, footing));
    return controls;
  }

 private:
  /// Height and tilt of the carrier on the ground at each knot, smoothed by its suspension or legs.
  struct Footing {
    std::vector<double> height, roll, pitch;
  };

  double arc(std::size_t k, double back) const { return std::max(0.0, distance_[k] - back); }

  Footing stand(double back, double turn) const {
    Footing footing;
    for (std::size_t k = 0; k < distance_.size(); ++k) {
      const Eigen::Vector2d place = route_.at(arc(k, back));
      const double yaw = route_.heading(arc(k, back)) + turn;
      const Eigen::Vector2d ahead = style_.wheelbase / 2 * Eigen::Vector2d(cos(yaw), sin(yaw));
      const Eigen::Vector2d left(-ahead.y(), ahead.x());
      const auto ground = [&](const Eigen::Vector2d& p) { return terrain_.height(p.x(), p.y()); };
      const double front = ground(place + ahead), rear = ground(place - ahead);
      const double left_side = ground(place + left), right_side = ground(place - left);
      footing.height.push_back((front + rear + left_side + right_side) / 4);
      footing.roll.push_back(atan2(left_side - right_side, style_.wheelbase));
      footing.pitch.push_back(-atan2(front - rear, style_.wheelbase));
    }
    for (std::vector<double>* series : {&footing.height, &footing.roll, &footing.pitch})
      for (int pass = 0; pass < 3; ++pass) *series = moving_average(*series, 3);
    return footing;
  }

  Vector6 control(std::size_t k, double back, double turn, const Footing& footing) const {
    const double t = knot_time(k), s = arc(k, back);
    const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, distance_.size() - 1);
    const double speed = (distance_[after] - distance_[before]) / (2 * kKnot);
    const double acceleration = (distance_[after] - 2 * distance_[k] + distance_[before]) / (kKnot * kKnot);
    const double turning =
        (route_.heading(arc(after, back)) - route_.heading(arc(before, back))) / (2 * kKnot);
    const double liveliness = std::min(1.0, speed / style_.fast_mps);

    // Braking lowers the nose (positive pitch), a left bend lifts the left side (positive roll).
    const double roll = footing.roll[k] + 0.006 * speed * turning + style_.sway * liveliness * roll_.at(t);
    const double pitch = footing.pitch[k] - 0.006 * acceleration + style_.sway * liveliness * pitch_.at(t);
    const double yaw = route_.heading(s) + turn;
    const Eigen::Vector3d up = yaw_pitch_roll(yaw, pitch, roll).col(2);
    const Eigen::Vector2d place = route_.at(s);
    const double height = footing.height[k] + style_.heave * liveliness * heave_.at(t);
    Vector6 control;
    control.head<3>() = Eigen::Vector3d(place.x(), place.y(), height) + style_.sensor_height * up;
    control.tail<3>() = Eigen::Vector3d(roll, pitch, yaw) + shaking(events_, t);
    return control;
  }

  const Polyline& route_;
  const Terrain& terrain_;
  const DriveStyle& style_;
  const std::vector<SimulationEvent>& events_;
  const std::vector<double>& distance_;
  Springs roll_, pitch_, heave_;
};

/// Metres along the route by which a kidnap moves the sensor back from arc length s.
double kidnap_distance(const Polyline& route, double s, double t, Random& random) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double back = random.uniform(kMinimumKidnap, kMaximumKidnap + 3);
    if (back > s) continue;
    const double moved = (route.at(s) - route.at(s - back)).norm();
    if (moved >= kMinimumKidnap && moved <= kMaximumKidnap) return back;
  }
  throw std::invalid_argument("kidnap at " + std::to_string(t) + " s: only " + std::to_string(s) +
                              " m are driven by then; choose a later time (it needs 3 m of driven path)");
}

}  // namespace

Drive::Drive(const Polyline& route, const Terrain& terrain, const DriveStyle& style,
             const std::vector<SimulationEvent>& events, double seconds, std::uint64_t seed) {
  Random random(seed, 1);
  distance_ = drive_distances(route, style, seconds, random);
  const PoseMaker maker(route, terrain, style, events, distance_, random);

  std::vector<SimulationEvent> kidnaps;
  for (const SimulationEvent& event : events)
    if (event.kind == EventKind::kKidnap && event.time_s < seconds) kidnaps.push_back(event);
  std::sort(kidnaps.begin(), kidnaps.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });

  double back = 0, turn = 0;
  for (std::size_t i = 0; i <= kidnaps.size(); ++i) {
    const double begin = i == 0 ? -kMargin : kidnaps[i - 1].time_s;
    if (i > 0) {
      back += kidnap_distance(route, distance(begin) - back, begin, random);
      turn += random.uniform(-kPi, kPi);
    }
    pieces_.push_back({begin, PoseSpline(kKnot - kMargin, kKnot, maker.controls(back, turn))});
  }
}

std::size_t Drive::piece_at(double t) const {
  std::size_t index = 0;
  while (index + 1 < pieces_.size() && t >= pieces_[index + 1].begin - 1e-9) ++index;
  return index;
}

double Drive::distance(double t) const {
  const double position = std::clamp((t + kMargin) / kKnot, 0.0, static_cast<double>(distance_.size() - 1));
  const std::size_t k = std::min(static_cast<std::size_t>(position), distance_.size() - 2);
  return distance_[k] + (position - static_cast<double>(k)) * (distance_[k + 1] - distance_[k]);
}

double driving_time(const Polyline& route, const DriveStyle& style, double distance_m, std::uint64_t seed) {
  Random random(seed, 1);
  const SpeedPlan plan = plan_drive(route, style, random);
  const double ahead_m = distance_m - kMargin * style.start_mps;  // a moving Drive starts that far along
  double seconds = plan.dwell[0];
  for (std::size_t i = 0; i + 1 < plan.limit.size() && plan.step * static_cast<double>(i) < ahead_m; ++i)
    seconds += travel_time(plan, i) + plan.dwell[i + 1];
  return seconds;
}

}  // namespace scanlock
