// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// align SOURCE TARGET: registers two levelled clouds without a start, refines the pose, and prints it as a
// 4x4 matrix that takes coordinates of SOURCE to those of TARGET. Exit 1 where the pose is not certain.
#include <exception>
#include <iostream>
#include <scanlock/align.hpp>
#include <scanlock/cloud_file.hpp>
#include <scanlock/registration.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: align SOURCE TARGET\n";
    return 2;
  }
  const scanlock::PointCloud source = scanlock::read_cloud(argv[1]), target = scanlock::read_cloud(argv[2]);

  // Four degrees of freedom: translation and heading, with a certificate.
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const scanlock::CloudRegistration start = scanlock::register_raw_clouds(source, target, up);

  // All six, from there, by robust point-to-plane ICP on thinned clouds.
  const double voxel = scanlock::sensible_voxel(target);
  scanlock::CloudTarget prepared(scanlock::thinned_by(target, voxel));
  prepared.prepare_normals();
  const auto method = scanlock::find_cloud_method("robust-icp-plane");
  const scanlock::CloudAlignment fine = scanlock::align_clouds(scanlock::thinned_by(source, voxel), prepared,
                                                               start.target_from_source, method.value());

  std::cout << fine.target_from_source.matrix() << "\n";
  std::cerr << scanlock::verdict_name(start.verdict) << ": " << start.why << "\n";
  return start.verdict == scanlock::GlobalVerdict::kCertain ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "align: " << error.what() << "\n";
  return 1;
}
