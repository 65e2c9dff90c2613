// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/stand_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "global/attitude_search.hpp"
#include "global/cloud_normals.hpp"

namespace scanlock {
namespace {

constexpr double kStep = 2;            // voxels between two stands: a glance sees that far
constexpr std::size_t kHeadings = 72;  // bins
constexpr std::size_t kMostTurns = 8;
constexpr std::size_t kMostStands = 2000;  // of more, only every other one or so
constexpr std::size_t kMostPoses = 40000;  // of all, in every attitude and heading: half a second of glances
constexpr double kWiderStep = 1.5;

using Headings = std::array<double, kHeadings>;

/// How many steep surfaces look which way.
Headings headings(const PointCloud& cloud) {
  Headings result{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_steep(cloud, i)) continue;
    const double turn = atan2(cloud.ny[i], cloud.nx[i]) / (2 * kPi) + 0.5;
    result[static_cast<std::size_t>(turn * kHeadings) % kHeadings] += 1;
  }
  return result;
}

/// Radians, at which the headings agree best, the best first.
std::vector<double> likely_turns(const Headings& source, const Headings& target) {
  Headings agreement{};
  for (std::size_t turn = 0; turn < kHeadings; ++turn) {
    for (std::size_t i = 0; i < kHeadings; ++i) agreement[turn] += source[i] * target[(i + turn) % kHeadings];
  }
  std::vector<std::size_t> peaks;
  for (std::size_t k = 0; k < kHeadings; ++k) {
    if (agreement[k] >= agreement[(k + 1) % kHeadings] &&
        agreement[k] > agreement[(k + kHeadings - 1) % kHeadings])
      peaks.push_back(k);
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [&](std::size_t a, std::size_t b) { return agreement[a] > agreement[b]; });
  peaks.resize(std::min(peaks.size(), kMostTurns));
  std::vector<double> turns;
  for (std::size_t k : peaks) turns.push_back(2 * kPi * static_cast<double>(k) / kHeadings);
  return turns;
}

/// Where the cloud was seen from, and a step beside it; in a fixed order.
std::vector<Eigen::Vector3d> stands(const PointCloud& cloud, double step) {
  std::map<std::pair<int, int>, float> seen_from, around;  // cells, and the height there
  for (const Eigen::Vector3f& eye : cloud.eyes) {
    const Eigen::Vector2i cell = (eye.head<2>().cast<double>() / step).array().floor().cast<int>();
    seen_from.emplace(std::pair(cell.x(), cell.y()), eye.z());
  }
  for (const auto& [cell, z] : seen_from) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) around.emplace(std::pair(cell.first + dx, cell.second + dy), z);
    }
  }
  std::vector<Eigen::Vector3d> result;
  for (const auto& [cell, z] : around)
    result.emplace_back((cell.first + 0.5) * step, (cell.second + 0.5) * step, z);
  return result;
}

}  // namespace

std::vector<Pose> stand_poses(const PointCloud& source, const PointCloud& target, double voxel,
                              const std::vector<Eigen::Vector3d>& ups) {
  double step = kStep * voxel;
  std::vector<Eigen::Vector3d> places = stands(target, step);
  std::vector<Pose> poses;
  const std::vector<double> turns = likely_turns(headings(source), headings(target));
  const std::size_t each = std::max<std::size_t>(turns.size() * ups_or_z(ups).size(), 1);
  while (places.size() > 1 && places.size() > std::min(kMostStands, kMostPoses / each))
    places = stands(target, step *= kWiderStep);
  for (const Eigen::Vector3d& up : ups_or_z(ups)) {
    const Eigen::Matrix3d level = level_rotation(up);
    for (double turn : turns) {
      Pose pose = Pose::Identity();
      pose.linear() = level.transpose() * rotation_about_z(turn);
      for (const Eigen::Vector3d& place : places) {
        pose.translation() = place;
        poses.push_back(pose);
      }
    }
  }
  return poses;
}

}  // namespace scanlock
