// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "global/cloud_registration.hpp"

namespace scanlock {
namespace {

constexpr double kTilt = 0.01;            // radians: the last good attitude is not that of the place found
constexpr double kStandReach = 20;        // metres
constexpr double kStandStep = 0.05;       // radians
constexpr std::size_t kMaxNodes = 20000;  // of a search: some tenths of a second

/// CPU time of this thread, milliseconds.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

PointCloud turned(PointCloud cloud, const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3f r = rotation.cast<float>();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p = r * cloud.point(i);
    cloud.x[i] = p.x();
    cloud.y[i] = p.y();
    cloud.z[i] = p.z();
  }
  return cloud;
}

/// The different ways in which the body stood, on the scans near the target's centre: its z axis in the
/// target's frame.
std::vector<Eigen::Vector3d> attitudes(const RecoveryRequest& request, const Eigen::Matrix3d& level) {
  std::vector<Eigen::Vector3d> ups;
  for (const ArchivedKeyframe& k : request.places) {
    if ((k.map_from_body.translation() - request.target_centre).norm() > kStandReach) continue;
    const Eigen::Vector3d up = level * k.map_from_body.linear().col(2);
    const auto alike = [&](const Eigen::Vector3d& other) { return up.dot(other) > std::cos(kStandStep); };
    if (std::none_of(ups.begin(), ups.end(), alike)) ups.push_back(up);
  }
  return ups;
}

}  // namespace

struct PlaceFinder::Target {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0, voxel = 0;
  std::size_t places = 0;
  std::int64_t newest = 0;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  CloudDescription description;

  bool is_of(const RecoveryRequest& request) const {
    return centre == request.target_centre && radius == request.radius && voxel == request.voxel &&
           up == request.up && places == request.places.size() &&
           (places == 0 || newest == request.places.back().utime);
  }
};

PlaceFinder::PlaceFinder() = default;
PlaceFinder::~PlaceFinder() = default;
PlaceFinder::PlaceFinder(PlaceFinder&&) noexcept = default;
PlaceFinder& PlaceFinder::operator=(PlaceFinder&&) noexcept = default;

RecoveryAnswer PlaceFinder::find(const RecoveryRequest& request) {
  const double begin = cpu_ms();
  const Eigen::Matrix3d level =
      Eigen::Quaterniond::FromTwoVectors(request.up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  DescriptionOptions options;
  options.voxel = request.voxel;
  if (!target_ || !target_->is_of(request)) {
    Target target;
    target.centre = request.target_centre;
    target.radius = request.radius;
    target.voxel = request.voxel;
    target.up = request.up;
    target.places = request.places.size();
    if (!request.places.empty()) target.newest = request.places.back().utime;
    target.description = describe(
        turned(submap_around(request.places, request.target_centre, request.radius, request.voxel), level),
        options);
    target_ = std::make_unique<Target>(std::move(target));
  }
  // The source is levelled by its own body: slopes turn the body, and where it stands now is not where it was
  // lost.
  const Eigen::Matrix3d stand =
      Eigen::Quaterniond::FromTwoVectors(request.body_up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const CloudDescription source = describe(turned(request.source, stand), options);

  CloudRegistrationOptions registration;
  registration.tilt = kTilt;
  registration.max_nodes = kMaxNodes;
  registration.target_ups = attitudes(request, level);
  const CloudRegistration found = register_clouds(source, target_->description, registration);

  RecoveryAnswer answer;
  answer.serial = request.serial;
  answer.utime = request.utime;
  answer.verdict = found.verdict == GlobalVerdict::kCertain     ? PlaceVerdict::kFound
                   : found.verdict == GlobalVerdict::kAmbiguous ? PlaceVerdict::kAmbiguous
                                                                : PlaceVerdict::kNotHere;
  // source: stand (p - source_centre); target: level (p - target_centre).
  Pose to_stand = Pose::Identity(), to_level = Pose::Identity();
  to_stand.linear() = stand;
  to_level.linear() = level;
  const Pose turn = to_level.inverse() * found.target_from_source * to_stand;
  answer.map_from_predicted =
      Eigen::Translation3d(request.target_centre) * turn * Eigen::Translation3d(-request.source_centre);
  answer.matches = static_cast<int>(found.solution.matches);
  answer.matches_kept = static_cast<int>(found.solution.matches_after_pruning);
  answer.consensus = found.solution.consensus;
  answer.upper_bound = found.solution.upper_bound;
  answer.runner_up_consensus = found.solution.runner_up_consensus;
  answer.certified = found.solution.certified;
  answer.reason = found.why;
  answer.nodes = static_cast<std::int64_t>(found.solution.nodes);
  answer.search_ms = found.solution.pruning_ms + found.solution.search_ms;
  answer.total_ms = cpu_ms() - begin;
  return answer;
}

}  // namespace scanlock
