// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Makes the logs of this folder: make_test_logs FOLDER. A log that is there stays as it is, for a log that
// broke something once is a test for ever; its recipe is here to be read, and to make others like it.
#include <bot_core/ins_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <mbot_lcm_msgs/lidar_t.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../odometry/room.hpp"
#include "geometry/voxel_grid.hpp"
#include "io/lcm_log.hpp"
#include "messages/encode.hpp"
#include "messages/encode_scan.hpp"
#include "messages/generated_bytes.hpp"
#include "simulation/simulator.hpp"

namespace {

using namespace scanlock;

constexpr std::int64_t kStart = 1600000000000000, kPeriod = 100000;  // microseconds

/// A log under way: what is written at which time.
class Recipe {
 public:
  void add(std::int64_t utime, const std::string& channel, Bytes data) {
    events_.push_back({utime, channel, std::move(data)});
  }
  void scan(const Scan& scan, std::int64_t event_utime) {
    for (Bytes& sector : encode_sectors(scan, {seq_++, "body"})) add(event_utime, "LIDAR", std::move(sector));
  }
  void write(const std::string& path) const {
    LogWriter log(path);
    for (const Event& event : events_) log.write(event.utime, event.channel, event.data);
    log.close();
  }

 private:
  struct Event {
    std::int64_t utime;
    std::string channel;
    Bytes data;
  };
  std::vector<Event> events_;
  std::int32_t seq_ = 1;
};

/// Every so many of the points.
Scan thinned(const Scan& scan, std::size_t points) {
  std::vector<std::uint32_t> some;
  for (std::size_t k = 0; k < points; ++k)
    some.push_back(static_cast<std::uint32_t>(k * scan.points.size() / points));
  Scan result;
  result.utime = scan.utime;
  result.points = scan.points.size() > points ? select(scan.points, some) : scan.points;
  return result;
}

std::vector<Scan> simulated(WorldKind world, LidarKind lidar, double seconds, std::uint64_t seed,
                            const std::vector<const char*>& events, std::size_t points, double first_s = 0,
                            bool stamp_at_end = false) {
  SimulationConfig config;
  config.world = world;
  config.lidar = lidar;
  config.seconds = seconds;
  config.seed = seed;
  config.stamp_at_end = stamp_at_end;
  for (const char* event : events) config.events.push_back(parse_event(event));
  Simulator simulator(config);
  std::vector<Scan> scans;
  while (const auto scan = simulator.next())
    if (scan->time_s >= first_s) scans.push_back(thinned(scan->scan, points));
  return scans;
}

Pose at(double x, double y, double heading) {
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp(Eigen::Vector3d(0, 0, heading));
  pose.translation() << x, y, 0;
  return pose;
}

Vector6 velocity(double ahead, double turning) {
  Vector6 v = Vector6::Zero();
  v[0] = ahead;
  v[5] = turning;
  return v;
}

/// A drive through the hall of test/odometry; it may be carried somewhere at a scan.
std::vector<Scan> hall_drive(int scans, int rays, const Vector6& v = velocity(1, 0.1), int kidnap = 1 << 20,
                             const Pose& there = Pose::Identity()) {
  std::vector<Scan> result;
  for (int i = 0; i < scans; ++i) {
    const Pose pose =
        i < kidnap ? at(-8, 0, 0) * se3_exp(0.1 * i * v) : there * se3_exp(0.1 * (i - kidnap) * v);
    result.push_back(hall_scan(pose, v, kStart + kPeriod * i, static_cast<unsigned>(i), 0.1, rays));
  }
  return result;
}

/// All scans as sectors, stamped and logged as they are.
Recipe plain(const std::vector<Scan>& scans) {
  Recipe recipe;
  for (const Scan& scan : scans) recipe.scan(scan, scan.utime);
  return recipe;
}

/// All scans in one type.
Recipe of_type(const std::vector<Scan>& scans,
               const std::function<Bytes(const Scan&, const ScanTags&)>& encode) {
  Recipe recipe;
  std::int32_t seq = 1;
  for (const Scan& scan : scans) recipe.add(scan.utime, "LIDAR", encode(scan, {seq++, "body"}));
  return recipe;
}

/// The hall with one thing done to scan `number`.
Recipe with_scan(int number, const std::function<void(Scan&)>& change) {
  std::vector<Scan> scans = hall_drive(30, 250);
  change(scans[static_cast<std::size_t>(number)]);
  Recipe recipe;
  for (std::size_t i = 0; i < scans.size(); ++i)
    recipe.scan(scans[i], kStart + kPeriod * static_cast<std::int64_t>(i));
  return recipe;
}

Bytes mbot_scan(const Scan& scan) {
  mbot_lcm_msgs::lidar_t message{};
  message.utime = scan.utime;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    message.ranges.push_back(scan.points.point(i).norm());
    message.thetas.push_back(std::atan2(scan.points.y[i], scan.points.x[i]));
    message.times.push_back(scan.utime + static_cast<std::int64_t>(1e6 * scan.points.time[i]));
    message.intensities.push_back(0);
  }
  message.num_ranges = static_cast<std::int32_t>(message.ranges.size());
  return generated_bytes(message);
}

/// Carried elsewhere before scan `kidnap`.
std::vector<Scan> planar_drive(int scans, int kidnap) {
  std::vector<Scan> result;
  for (int i = 0; i < scans; ++i) {
    const Vector6 v = velocity(1, 0.2);
    const Pose pose = i < kidnap ? at(-8, 0, 0) * se3_exp(0.1 * i * v)
                                 : at(-5, 1, 20 * kDegree) * se3_exp(0.1 * (i - kidnap) * v);
    result.push_back(planar_hall_scan(pose, v, kStart + kPeriod * i, static_cast<unsigned>(i)));
  }
  return result;
}

Recipe planar_recipe(int scans, int kidnap) {
  return of_type(planar_drive(scans, kidnap),
                 [](const Scan& s, const ScanTags&) { return encode_planar_lidar(s, 360); });
}

void add_priors(const std::vector<Scan>& scans, double speed, Recipe& recipe) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (int k = 0; k < 5; ++k) {
      const std::int64_t utime = scans[i].utime - 80000 + 20000 * k;
      bot_core::pose_t wheels{};
      wheels.utime = utime;
      wheels.pos[0] = 1e-6 * speed * static_cast<double>(utime - kStart);
      wheels.orientation[0] = 1;
      recipe.add(utime, "WHEELS", generated_bytes(wheels));
      bot_core::ins_t level{};
      level.utime = utime;
      level.quat[0] = 1;
      recipe.add(utime, "IMU", generated_bytes(level));
    }
    recipe.scan(scans[i], scans[i].utime);
  }
}

Bytes command(CommandKind kind, const Pose& pose = Pose::Identity()) {
  Command wish;
  wish.kind = kind;
  wish.map_from_body = pose;
  return encode_command(wish);
}

std::vector<std::pair<std::string, std::function<Recipe()>>> recipes() {
  const auto indoor = [](std::size_t points) {
    return simulated(WorldKind::kIndoor, LidarKind::kVlp16, 2.5, 7, {}, points);
  };
  return {
      // ---- types
      {"type_pointcloud2", [=] { return of_type(indoor(250), encode_pointcloud2); }},
      {"type_pointcloud", [=] { return of_type(indoor(250), encode_pointcloud); }},
      {"type_drake", [=] { return of_type(indoor(250), encode_drake_point_cloud); }},
      {"type_ros_pointcloud2", [=] { return of_type(indoor(250), encode_ros_pointcloud2); }},
      {"type_sectors", [=] { return plain(indoor(400)); }},
      {"type_planar_lidar", [] { return planar_recipe(50, 50); }},
      {"type_mbot_lidar",
       [] {
         return of_type(planar_drive(12, 12), [](const Scan& s, const ScanTags&) { return mbot_scan(s); });
       }},
      // ---- stamps and times of points
      {"stamp_at_the_end",
       [] { return plain(simulated(WorldKind::kUrban, LidarKind::kVlp16, 4, 7, {}, 400, 0, true)); }},
      {"stamp_none",
       [] {
         Recipe recipe;
         for (Scan scan : hall_drive(30, 300)) {
           const std::int64_t event = std::exchange(scan.utime, 0);
           recipe.scan(scan, event);
         }
         return recipe;
       }},
      {"times_of_points_none",
       [] {
         std::vector<Scan> scans = hall_drive(30, 300);
         for (Scan& scan : scans) scan.points.time.clear();
         return plain(scans);
       }},
      // ---- clocks
      {"clock_one_stamp_an_hour_ahead", [] { return with_scan(15, [](Scan& s) { s.utime += 3600000000; }); }},
      {"clock_one_stamp_of_1", [] { return with_scan(15, [](Scan& s) { s.utime = 1; }); }},
      {"clock_repeated_stamp", [] { return with_scan(15, [](Scan& s) { s.utime -= kPeriod; }); }},
      {"clock_steps_back",
       [] {
         Recipe recipe;
         for (Scan scan : hall_drive(30, 300)) {
           const std::int64_t event = scan.utime;
           if (event >= kStart + 15 * kPeriod) scan.utime -= 500000;
           recipe.scan(scan, event);
         }
         return recipe;
       }},
      {"clock_log_that_loops",
       [] {
         Recipe recipe;
         for (int lap = 0; lap < 2; ++lap)
           for (const Scan& scan : hall_drive(30, 250, velocity(2, 0)))
             recipe.scan(scan, scan.utime + 3000000 * lap);
         return recipe;
       }},
      {"two_publishers",
       [] {
         Recipe recipe;
         for (const Scan& scan : hall_drive(30, 200)) {
           recipe.scan(scan, scan.utime);
           Scan other = hall_scan(at(6, -3, 2), Vector6::Zero(), scan.utime + 12000000, 1, 0.1, 200);
           recipe.scan(other, scan.utime + 50000);
         }
         return recipe;
       }},
      // ---- drives
      {"drive_urban", [] { return plain(simulated(WorldKind::kUrban, LidarKind::kHdl64, 4, 3, {}, 400)); }},
      {"drive_forest", [] { return plain(simulated(WorldKind::kForest, LidarKind::kVlp16, 4, 3, {}, 400)); }},
      {"drive_mid360",
       [] { return plain(simulated(WorldKind::kIndoor, LidarKind::kMid360, 4, 3, {}, 400)); }},
      {"drive_starts_in_motion",
       [] { return plain(simulated(WorldKind::kUrban, LidarKind::kVlp16, 13, 5, {}, 400, 10)); }},
      {"drive_tunnel",
       [] { return plain(simulated(WorldKind::kTunnel, LidarKind::kVlp16, 13, 3, {}, 400, 9.5)); }},
      {"drive_field", [] { return plain(simulated(WorldKind::kField, LidarKind::kVlp16, 4, 3, {}, 400)); }},
      // ---- events
      {"event_kidnap", [] { return plain(hall_drive(62, 300, velocity(1, 0.1), 35, at(-3, -2, 2.6))); }},
      {"event_kidnap_planar", [] { return planar_recipe(62, 50); }},
      {"event_kidnap_in_a_gap",
       [] {
         std::vector<Scan> scans = hall_drive(60, 600, velocity(1, 0.1), 32, at(0, -1, 2.9));
         scans.erase(scans.begin() + 32, scans.begin() + 37);
         return plain(scans);
       }},
      {"event_blackout",
       [] {
         std::vector<Scan> scans = hall_drive(65, 300, velocity(0.8, 0.1));
         for (std::size_t i = 30; i < 50; ++i) scans[i] = thinned(scans[i], i % 2 == 0 ? 0 : 15);
         return plain(scans);
       }},
      {"event_half_view",
       [] {
         std::vector<Scan> scans = hall_drive(45, 300);
         for (std::size_t i = 20; i < 35; ++i) scans[i] = half_of(scans[i]);
         return plain(scans);
       }},
      {"event_shake",
       [] { return plain(simulated(WorldKind::kIndoor, LidarKind::kVlp16, 4, 9, {"shake@2+1"}, 500)); }},
      {"event_carried_to_another_building",  // ends LOST
       [] {
         std::vector<Scan> scans = hall_drive(25, 250);
         for (const Scan& scan : simulated(WorldKind::kIndoor, LidarKind::kVlp16, 9, 7, {}, 250)) {
           scans.push_back(scan);
           scans.back().utime += 2500000;
         }
         return plain(scans);
       }},
      {"event_carried_in_a_hall_of_two_like_ends",  // ends AMBIGUOUS
       [] {
         std::vector<Scan> scans;
         for (int i = 0; i < 70; ++i) {
           const Pose pose = i < 40 ? at(-8 + 0.4 * i, 0, 0) : at(2, 3 - 0.05 * (i - 40), 2.5);
           scans.push_back(bare_hall_scan(pose, kStart + kPeriod * i, static_cast<unsigned>(i)));
         }
         return plain(scans);
       }},
      {"event_sectors_lost",
       [] {
         Recipe recipe;
         std::int32_t seq = 1;
         for (const Scan& scan : hall_drive(40, 400)) {
           std::vector<Bytes> sectors = encode_sectors(scan, {seq, "body"}, 1000);
           if (seq % 5 == 0) sectors.erase(sectors.begin() + 1);
           if (seq % 7 == 0) sectors.push_back(sectors.front());
           for (Bytes& sector : sectors) recipe.add(scan.utime, "LIDAR", std::move(sector));
           ++seq;
         }
         return recipe;
       }},
      {"event_damaged_messages",
       [] {
         Recipe recipe;
         int number = 0;
         for (const Scan& scan : hall_drive(20, 300)) {
           Bytes bytes = encode_pointcloud2(scan);
           if (++number % 6 == 0) bytes.resize(bytes.size() / 2);
           if (number % 7 == 0) bytes[3] ^= 0x55;
           recipe.add(scan.utime, "LIDAR", std::move(bytes));
         }
         return recipe;
       }},
      // ---- other sensors, commands
      {"priors",
       [] {
         Recipe recipe;
         add_priors(hall_drive(30, 250, velocity(1, 0)), 1, recipe);
         return recipe;
       }},
      {"priors_that_contradict",
       [] {
         Recipe recipe;
         add_priors(hall_drive(30, 250, velocity(1, 0)), 4, recipe);
         return recipe;
       }},
      {"commands",
       [] {
         Recipe recipe;
         int number = 0;
         for (const Scan& scan : hall_drive(40, 300)) {
           if (number == 10) recipe.add(scan.utime - 1, "SCANLOCK_COMMAND", command(CommandKind::kReset));
           if (number == 20)
             recipe.add(scan.utime - 1, "SCANLOCK_COMMAND", command(CommandKind::kSetPose, at(100, -50, 1)));
           if (number == 30) recipe.add(scan.utime - 1, "SCANLOCK_COMMAND", command(CommandKind::kSaveMap));
           recipe.scan(scan, scan.utime);
           ++number;
         }
         return recipe;
       }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_test_logs FOLDER\n");
    return 2;
  }
  for (const auto& [name, make] : recipes()) {
    const std::string path = std::string(argv[1]) + "/" + name + ".lcmlog";
    if (std::filesystem::exists(path)) continue;
    make().write(path);
    std::printf("%s: %ju bytes\n", path.c_str(),
                static_cast<std::uintmax_t>(std::filesystem::file_size(path)));
  }
  return 0;
}
