// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>
#include <stdexcept>
#include <string>

#include "geometry/elementary.hpp"
#include "simulation/random.hpp"

namespace scanlock {
namespace {

constexpr double kDefaultSeconds = 60, kLongest = 90000;  // seconds
constexpr int kMostLaps = 1000;
constexpr std::size_t kBlock = 2048;    // beams that share a random stream
constexpr std::uint64_t kNoise = 1000;  // random stream of sweep 0's noise; each sweep has its own

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

SimulationConfig checked(const SimulationConfig& config) {
  if (config.seconds && (!(*config.seconds > 0) || *config.seconds > kLongest))
    throw std::invalid_argument("seconds must be more than 0 and at most 90000");
  if (config.laps && (*config.laps < 1 || *config.laps > kMostLaps))
    throw std::invalid_argument("laps must lie between 1 and 1000");
  if (!(config.speed_mps >= 0) || config.speed_mps > 60)
    throw std::invalid_argument("the speed must lie between 0 and 60 m/s");
  if (!(config.start_speed_mps >= 0) || config.start_speed_mps > 60)
    throw std::invalid_argument("the speed at the start must lie between 0 and 60 m/s");
  if (config.noise_m && !(*config.noise_m >= 0 && *config.noise_m <= 10))
    throw std::invalid_argument("the noise must lie between 0 and 10 m");
  if (!(config.moved >= 0 && config.moved <= 1))
    throw std::invalid_argument("the share of moved objects must lie between 0 and 100 %");
  if (config.column_step < 1 || config.column_step > 100)
    throw std::invalid_argument("the step of the columns must lie between 1 and 100");
  if (config.threads < 1 || config.threads > 256)
    throw std::invalid_argument("threads must lie between 1 and 256");
  return config;
}

LidarModel lidar_of(const SimulationConfig& config) {
  LidarModel lidar = LidarModel::of(config.lidar);
  lidar.noise = config.noise_m.value_or(lidar.noise);
  lidar.column_step = config.column_step;
  return lidar;
}

World world_of(const SimulationConfig& config) {
  Visit visit;
  visit.seconds = config.seconds.value_or(kDefaultSeconds);
  visit.laps = config.laps.value_or(0);
  visit.speed_mps = config.speed_mps;
  visit.start_mps = config.start_speed_mps;
  visit.seed = config.drive_seed;
  visit.moved = config.moved;
  return make_world(config.world, config.seed, visit);
}

std::uint64_t drive_seed(const SimulationConfig& config) {
  return config.drive_seed.value_or(config.seed);
}

/// Length of the drive in seconds. Throws std::invalid_argument for laps that take too long, a drive shorter
/// than one scan, and an event after its end.
double drive_seconds(const SimulationConfig& config, const World& world, const LidarModel& lidar) {
  double seconds = config.seconds.value_or(config.laps ? kLongest : kDefaultSeconds);
  if (config.laps) {
    const double laps_s = driving_time(world.route, world.style, world.laps_end_m, drive_seed(config));
    if (laps_s > kLongest && !config.seconds)
      throw std::invalid_argument("the laps take " + text_of(laps_s) +
                                  " s, more than 90000: choose fewer laps or a higher speed");
    seconds = std::min(seconds, laps_s);
  }
  if (std::floor(seconds / lidar.period_s + 1e-6) < 1)
    throw std::invalid_argument("no whole scan fits into " + text_of(seconds) + " seconds");
  for (const SimulationEvent& event : config.events) {
    if (event.time_s >= seconds)
      throw std::invalid_argument("an event at " + text_of(event.time_s) +
                                  " s is not reached: the drive ends after " + text_of(seconds) + " s");
  }
  return seconds;
}

}  // namespace

/// A mover during one sweep: its shapes at the start of the sweep, and its velocity.
struct Simulator::Moving {
  Eigen::Vector3d position, velocity;
  double reach;  // its shapes lie within this horizontal distance of the position
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
};

Simulator::Simulator(const SimulationConfig& config)
    : config_(checked(config)),
      lidar_(lidar_of(config)),
      world_(world_of(config)),
      seconds_(drive_seconds(config, world_, lidar_)),
      drive_(world_.route, world_.scene.terrain(), world_.style, config.events, seconds_, drive_seed(config)),
      beams_(lidar_.sweep(0)) {}

std::int64_t Simulator::sweeps() const {
  return static_cast<std::int64_t>(std::floor(seconds_ / lidar_.period_s + 1e-6));
}

Pose Simulator::pose_at(double t, double sweep_begin) const {
  return drive_.piece(drive_.piece_at(sweep_begin)).pose(t);
}

bool Simulator::event_active(EventKind kind, double t) const {
  for (const SimulationEvent& event : config_.events)
    if (event.kind == kind && event.active(t)) return true;
  return false;
}

std::optional<SimulatedScan> Simulator::next() {
  while (sweep_ < sweeps() &&
         event_active(EventKind::kDropout, static_cast<double>(sweep_) * lidar_.period_s))
    ++sweep_;
  if (sweep_ >= sweeps()) return std::nullopt;
  if (!lidar_.repeats()) beams_ = lidar_.sweep(sweep_);
  return make_scan(sweep_++);
}

float Simulator::point_time(const Beam& beam) const {
  if (!config_.motion_distortion) return 0;
  return config_.stamp_at_end ? static_cast<float>(beam.time - lidar_.period_s) : beam.time;
}

SimulatedScan Simulator::make_scan(std::int64_t sweep) const {
  const double begin = static_cast<double>(sweep) * lidar_.period_s;
  const double stamp = begin + (config_.stamp_at_end ? lidar_.period_s : 0);
  const PoseSpline& motion = drive_.piece(drive_.piece_at(begin));
  SimulatedScan out;
  out.time_s = stamp;
  out.scan.utime = kStartUtime + std::llround(stamp * 1e6);
  out.world_from_body = motion.pose(stamp);
  out.twist = motion.twist(stamp);

  const bool blackout = event_active(EventKind::kBlackout, begin);
  if (blackout && sweep % 2 == 0) return out;
  const Eigen::Vector3d forward = out.world_from_body.linear().col(0);
  const auto movers = movers_near(out.world_from_body.translation(), atan2(forward.y(), forward.x()), begin);
  std::vector<Return> returns(beams_.size());
  std::vector<std::future<void>> workers;
  const std::size_t blocks = (beams_.size() + kBlock - 1) / kBlock;
  const std::size_t threads = std::min(blocks, static_cast<std::size_t>(config_.threads));
  const auto work = [&](std::size_t worker) {
    for (std::size_t block = worker; block < blocks; block += threads)
      cast_beams(sweep, stamp, movers, block * kBlock, std::min(beams_.size(), (block + 1) * kBlock),
                 returns.data());
  };
  for (std::size_t i = 1; i < threads; ++i) workers.push_back(std::async(std::launch::async, work, i));
  work(0);
  for (auto& worker : workers) worker.get();

  const std::size_t limit = blackout ? 20 : returns.size();
  PointCloud& points = out.scan.points;
  for (std::size_t i = 0; i < returns.size() && points.size() < limit; ++i) {
    if (returns[i].range <= 0) continue;
    points.push_back((returns[i].range * beams_[i].direction).cast<float>());
    points.intensity.push_back(returns[i].intensity);
    points.time.push_back(point_time(beams_[i]));
  }
  return out;
}

std::vector<Simulator::Moving> Simulator::movers_near(const Eigen::Vector3d& sensor, double heading,
                                                      double t) const {
  std::vector<Moving> near;
  const double until = t + lidar_.period_s;
  const bool kidnapped = drive_.piece_at(t) > 0;
  for (const Mover& mover : world_.movers) {
    if (mover.in_convoy && mover.start < 0 && kidnapped) continue;  // could be where the sensor was put
    const auto arc = [&](double time) {
      if (mover.in_convoy) return drive_.distance(time) + mover.start + 5 * sin(0.11 * time);
      return std::fmod(mover.start + mover.speed * t, mover.path.length()) + mover.speed * (time - t);
    };
    const double s = arc(t);
    if (s < 0) continue;
    const Eigen::Vector2d from = mover.path.at(s), to = mover.path.at(arc(until));
    const Eigen::Vector2d apart = from - sensor.head<2>();
    if (apart.norm() > lidar_.max_range) continue;
    if (!mover.in_convoy) {
      // Movers within 4 m are left out, since they could pass through the sensor; so are cars within 60 m in
      // the sensor's own lane, which is for the convoy only.
      if (apart.norm() < 4) continue;
      const Eigen::Vector2d ahead(cos(heading), sin(heading));
      const double aside = std::abs(apart.x() * ahead.y() - apart.y() * ahead.x());
      const bool same_way = cos(mover.path.heading(s) - heading) > 0.7;
      if (same_way && aside < 1.7 && apart.norm() < 60 && !mover.boxes.empty()) continue;
    }
    const auto ground = [&](const Eigen::Vector2d& p) {
      return Eigen::Vector3d(p.x(), p.y(), world_.scene.terrain().height(p.x(), p.y()));
    };
    Moving moving;
    moving.position = ground(from);
    moving.velocity = (ground(to) - moving.position) / lidar_.period_s;
    moving.reach = 0;
    const Eigen::Matrix3d turn = rotation_about_z(mover.path.heading(s));
    for (Box box : mover.boxes) {
      moving.reach = std::max(moving.reach, box.centre.head<2>().norm() + box.half.head<2>().norm());
      box.centre = moving.position + turn * box.centre;
      box.world_from_box = turn * box.world_from_box;
      moving.boxes.push_back(box);
    }
    for (Cylinder cylinder : mover.cylinders) {
      moving.reach = std::max(moving.reach, cylinder.base.head<2>().norm() + cylinder.radius);
      cylinder.base = moving.position + turn * cylinder.base;
      moving.cylinders.push_back(cylinder);
    }
    near.push_back(std::move(moving));
  }
  return near;
}

Hit Simulator::cast(const Ray& ray, double since, const std::vector<Moving>& movers,
                    std::uint64_t seed) const {
  Hit hit = world_.scene.cast(ray, lidar_.max_range, seed);
  const Eigen::Vector2d flat = ray.direction.head<2>();
  for (const Moving& mover : movers) {
    const Ray relative{ray.origin - since * mover.velocity, ray.direction};
    const Eigen::Vector2d apart = (mover.position - relative.origin).head<2>();
    const double aside = apart.x() * flat.y() - apart.y() * flat.x();
    if (aside * aside > mover.reach * mover.reach || apart.dot(flat) < -mover.reach) continue;
    for (const Box& box : mover.boxes) intersect(box, relative, hit);
    for (const Cylinder& cylinder : mover.cylinders) intersect(cylinder, relative, hit);
  }
  return hit;
}

void Simulator::cast_beams(std::int64_t sweep, double stamp, const std::vector<Moving>& movers,
                           std::size_t begin, std::size_t end, Return* returns) const {
  const double sweep_begin = static_cast<double>(sweep) * lidar_.period_s;
  const PoseSpline& motion = drive_.piece(drive_.piece_at(sweep_begin));
  const bool half_view = event_active(EventKind::kHalfView, sweep_begin);
  Random random(drive_seed(config_), kNoise + static_cast<std::uint64_t>(sweep), begin);
  Pose pose = Pose::Identity();
  float pose_time = HUGE_VALF;  // not the time of any beam
  for (std::size_t i = begin; i < end; ++i) {
    const Beam& beam = beams_[i];
    const float time = point_time(beam);
    if (time != pose_time) {
      pose = motion.pose(stamp + static_cast<double>(time));
      pose_time = time;
    }
    const std::uint64_t leaf_seed = random.bits();
    if (half_view && beam.direction.y() > 0) continue;
    const Ray ray{pose.translation(), pose.linear() * beam.direction};
    const Hit hit = cast(ray, stamp + static_cast<double>(time) - sweep_begin, movers, leaf_seed);
    if (!hit.found) continue;
    const double cosine = std::abs(hit.normal.dot(ray.direction));
    if (random.chance(lidar_.loss(hit.range, cosine, hit.reflectivity))) continue;
    const double noisy = hit.range + lidar_.noise * random.gaussian();
    const double range = std::round(noisy / lidar_.quantum) * lidar_.quantum;
    if (range < lidar_.min_range || range > lidar_.max_range) continue;
    returns[i].range = static_cast<float>(range);
    returns[i].intensity = static_cast<float>(std::round(255 * hit.reflectivity * cosine));
  }
}

}  // namespace scanlock
