// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The command line of scanlock-align for clouds.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "align_global.hpp"
#include "align_verdict.hpp"
#include "command_line.hpp"
#include "icp/cloud_alignment.hpp"

namespace scanlock {

struct AlignOptions {
  std::string source, target, init, truth, output, picture, poses;
  std::vector<std::string> more;  // clouds of a chain, from the third on
  std::string method;             // empty: not given
  std::vector<double> up = {0, 0, 1};
  double epsilon = 0;
  double voxel = -1;  // negative: not given
  double nu_max = 0, nu_min = 0;
  int threads = 1;
  std::string accept = "certain";
  bool thorough = false, chain = false, json = false, force = false;
};

inline constexpr const char* kAlignFooter =
    R"(SOURCE and TARGET: .ply, .pcd, .bin (KITTI) or .xyz/.txt. T.txt: 4x4, row-major text; maps source into target coordinates.
Normals of .ply and .pcd files are used; where they are missing they are estimated.

icp, aa-icp, fast-icp                      squared distances; plain, accelerated by Euler angles, accelerated in se(3)
4dof                                       for levelled clouds, without an initial guess: the rotation about --up and the
                                           translation with the largest consensus of feature matches, with its
                                           certificate, checked against the clouds
4dof+robust-icp, 4dof+robust-icp-plane     the same, then refined. 4dof+robust-icp, the default without --init, keeps
                                           the 4dof pose if its point-to-plane energy is lower, and refines the kept
                                           pose by distances to tangent planes
robust-icp                                 Welsch's function; nu falls from 3 median residuals to the point spacing of the target
icp-plane, fast-icp-plane, robust-icp-plane   the same with distances to tangent planes
symmetric-icp, robust-symmetric-icp        the same with the normals of both clouds

scanlock-align --correspondences FILE --epsilon METRES solves a file of candidate matches instead; see its --help.)";

inline void declare_align_options(CommandLine line, AlignOptions& options) {
  line.explain(kAlignFooter,
               {"scanlock-align scan.ply site.ply --json",
                "scanlock-align scan.ply site.ply --init T.txt --picture alignment.svg --output aligned.ply",
                "scanlock-align scans/*.bin --chain --poses poses.tum --output map.ply"});
  line.option("SOURCE", options.source, "the cloud to move").required();
  line.option("TARGET", options.target, "the cloud to move it to").required();
  line.option("MORE", options.more, "with --chain: further clouds");
  line.flag(
      "--chain", options.chain,
      "register each cloud to the one before it; --output is the map, thinned like the clouds. With 4dof, "
      "a pair whose verdict --accept does not allow ends the program (exit 1); with --json it continues, and "
      "the verdict is in the pair's link");
  line.option("--poses", options.poses,
              "with --chain: write the poses here, TUM, stamped 0, 1, 2, ..., in the frame of the first");
  line.option("--method", options.method,
              "see below (default: 4dof+robust-icp; with --init: robust-icp-plane)");
  line.option("--init", options.init, "start from this transform (default: identity)");
  line.option("--truth", options.truth, "compare the result with this transform");
  line.option("--voxel", options.voxel,
              "thin both clouds to one point per voxel of this size, metres; 0: all points (default: from "
              "the size of the scene)")
      .from_zero();
  line.option("--up", options.up, "4dof: the vertical of both clouds (default: 0,0,1)").comma_separated(3);
  line.option("--epsilon", options.epsilon, "4dof: inlier threshold, metres (default: from the voxel)")
      .above_zero();
  line.option("--nu-max", options.nu_max, "first scale, metres (default: three times the median residual)")
      .above_zero();
  line.option("--nu-min", options.nu_min, "last scale, metres (default: from the sampling of the target)")
      .above_zero();
  line.flag("--thorough", options.thorough,
            "use all points and the final tolerance at every scale, as the paper does");
  line.option("--threads", options.threads, "threads; the result does not depend on them (default: 1)")
      .within(1, 256);
  line.option("--output", options.output, "write the aligned source here");
  line.option("--picture", options.picture, "write an SVG picture here");
  add_accept_option(
      line, options.accept,
      "verdicts with exit code 0: certain (default; without 4dof: converged and not degenerate), "
      "ambiguous (accepts ambiguous or degenerate ones, too), or any");
  line.flag("--force", options.force, "overwrite outputs that are there already");
  line.flag("--json", options.json, "print one JSON object");
}

/// Sets the members that follow from other options; throws UsageError for options that exclude each other.
inline void settle_align_options(AlignOptions& options) {
  if (options.method.empty()) options.method = options.init.empty() ? "4dof+robust-icp" : "robust-icp-plane";
  const Eigen::Vector3d up(options.up.data());
  for (const auto& [wrong, words] :
       {std::pair{is_global(options.method) && !options.init.empty(),
                  "--init cannot be used with the 4dof methods"},
        std::pair{!up.allFinite() || !(up.norm() > 1e-9), "--up must be finite, and not 0,0,0"},
        std::pair{!options.chain && !options.more.empty(), "more than two clouds need --chain"},
        std::pair{!options.chain && !options.poses.empty(), "--poses needs --chain"},
        std::pair{options.chain && !(options.init + options.truth + options.picture).empty(),
                  "--init, --truth and --picture cannot be used with --chain"}}) {
    if (wrong) throw UsageError(words);
  }
  const std::string refining = refining_method(options.method);
  if (refining.empty() || find_cloud_method(refining)) return;
  std::string names = " 4dof 4dof+robust-icp 4dof+robust-icp-plane";
  for (const std::string& name : cloud_method_names()) names += " " + name;
  throw UsageError("--method " + options.method + " is unknown; known are" + names);
}

inline CloudAlignmentOptions alignment_options(const AlignOptions& options) {
  CloudAlignmentOptions alignment;
  alignment.nu_max = options.nu_max;
  alignment.nu_min = options.nu_min;
  alignment.thorough = options.thorough;
  alignment.threads = options.threads;
  return alignment;
}

}  // namespace scanlock
