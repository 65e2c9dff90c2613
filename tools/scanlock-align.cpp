// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-align: aligns two clouds, a chain of clouds, or matches.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "align_chain.hpp"
#include "align_global.hpp"
#include "align_input.hpp"
#include "align_matches.hpp"
#include "align_options.hpp"
#include "align_report.hpp"
#include "align_verdict.hpp"
#include "command_line.hpp"
#include "evaluation/alignment_picture.hpp"
#include "geometry/angles.hpp"
#include "icp/cloud_alignment.hpp"
#include "icp/cloud_thinning.hpp"
#include "io/cloud_file.hpp"
#include "io/file_bytes.hpp"
#include "io/output_files.hpp"
#include "io/progress_bar.hpp"

namespace {

using namespace scanlock;

struct Milliseconds {
  double read = 0, normals = 0, index = 0, solve = 0, total = 0;
};

/// Equation 12.
double rmse(const PointCloud& cloud, const Pose& a, const Pose& b) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = cloud.point(i).cast<double>();
    if (!p.allFinite()) continue;
    sum += (a * p - b * p).squaredNorm();
    ++n;
  }
  return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0;
}

/// The numbers of points that were aligned, and the voxel to which they were thinned (metres).
struct RunSizes {
  std::size_t source = 0, target = 0;
  double voxel = 0;
};

Json result_json(const AlignOptions& options, const CloudAlignment& result, const RunSizes& sizes,
                 const Milliseconds& ms) {
  return {{"method", options.method},
          {"transform", row_major(result.target_from_source.matrix())},
          {"points", {sizes.source, sizes.target}},
          {"voxel", sizes.voxel},
          {"iterations", result.iterations},
          {"sweeps", result.sweeps},
          {"stop_reason", result.stop_reason},
          {"energy", result.energy},
          {"inlier_ratio", result.inlier_ratio},
          {"nu", {result.nu_max, result.nu_min}},
          {"searches", {{"made", result.searches_made}, {"saved", result.searches_saved}}},
          {"covariance", row_major(result.covariance)},
          {"degenerate_axes", axis_names(result.degenerate_axes)},
          {"ms",
           {{"read", ms.read},
            {"normals", ms.normals},
            {"index", ms.index},
            {"solve", ms.solve},
            {"total", ms.total}}},
          {"peak_rss_mb", peak_rss_mb()}};
}

void add_truth(const PointCloud& source, const Pose& found, const Pose& truth, Json* json) {
  const Pose error = truth.inverse() * found;
  (*json)["rmse"] = rmse(source, found, truth);
  (*json)["rotation_error_deg"] = so3_log(error.linear()).norm() / kDegree;
  (*json)["translation_error"] = (found.translation() - truth.translation()).norm();
}

CloudTarget make_target(const AlignOptions& options, const PointCloud& cloud) {
  try {
    return CloudTarget(cloud, options.threads);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(options.target + ": " + error.what());
  }
}

Eigen::Vector3d middle_of(const PointCloud& cloud) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.point(i).allFinite()) continue;
    sum += cloud.point(i).cast<double>();
    ++count;
  }
  return sum / std::max(count, 1.0);
}

/// Refines a start by a method of ICP. Frees the memory of the target unless a picture needs it.
CloudAlignment refine(const AlignOptions& options, const CloudMethod& method, const PointCloud& source_file,
                      PointCloud& target_file, const Pose& start, const GlobalStart* global, RunSizes* sizes,
                      Milliseconds* ms) {
  Stopwatch watch;
  const double voxel = options.voxel >= 0 ? options.voxel : sensible_voxel(target_file);
  const PointCloud thin_source = voxel > 0 ? thinned_by(source_file, voxel) : PointCloud{};
  const PointCloud thin_target = voxel > 0 ? thinned_by(target_file, voxel) : PointCloud{};
  const PointCloud& source = voxel > 0 ? thin_source : source_file;
  const PointCloud& target_cloud = voxel > 0 ? thin_target : target_file;
  CloudTarget target = make_target(options, target_cloud);
  *sizes = {source.size(), target_cloud.size(), voxel};
  if (options.picture.empty()) target_file = PointCloud{};  // CloudTarget has its own copy
  ms->index = watch.lap();
  if (method.needs_normals() || global)
    target.prepare_normals(options.threads, nullptr, CloudTarget::normal_neighbours(voxel));
  ms->normals = watch.lap();
  CloudAlignmentOptions alignment = alignment_options(options);
  alignment.voxel = voxel;
  ProgressBar bar("aligning");
  alignment.progress = [&](double share) { bar.update(static_cast<std::uint64_t>(1000 * share), 1000); };
  if (global && global->found()) {
    alignment.start_may_be_better = true;
    if (!(options.nu_max > 0)) alignment.nu_max = global->registration.epsilon;
  }
  try {
    CloudAlignment result = align_clouds(source, target, start, method, alignment);
    if (global && global->is_left_by(result.target_from_source, middle_of(source))) {
      // Point-to-point ICP lets sparse points slide along surfaces: tries point-to-plane ICP, and if that
      // leaves the confirmed pose, too, keeps the start.
      result = align_clouds(source, target, start, *find_cloud_method("robust-icp-plane"), alignment);
      if (global->is_left_by(result.target_from_source, middle_of(source))) {
        result.target_from_source = start;
        result.stop_reason = "start";
      }
    }
    ms->solve += watch.lap();
    return result;
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(options.source + ": " + error.what());
  }
}

int run(const AlignOptions& options) {
  const std::string refining = refining_method(options.method);
  Stopwatch whole, watch;
  Milliseconds ms;
  PointCloud source = read_points(options.source), target = read_points(options.target);
  Pose start = options.init.empty() ? Pose::Identity() : read_transform(options.init);
  const Pose truth = options.truth.empty() ? Pose::Identity() : read_transform(options.truth);
  ms.read = watch.lap();
  const Pose given = start;
  std::optional<GlobalStart> global;
  if (is_global(options.method)) {
    global =
        GlobalSearch(Eigen::Vector3d(options.up.data()), options.voxel, options.epsilon).next(source, target);
    if (refining.empty() || global->found()) start = global->pose(!refining.empty());
  }
  ms.solve = watch.lap();
  if (options.output.empty()) source.intensity = {};
  target.intensity = {};
  RunSizes sizes{source.size(), target.size(), options.voxel > 0 ? options.voxel : 0};
  CloudAlignment result;
  if (refining.empty()) {
    result.target_from_source = start;
    result.stop_reason = verdict_name(global->registration.verdict);
  } else {
    result = refine(options, *find_cloud_method(refining), source, target, start, global ? &*global : nullptr,
                    &sizes, &ms);
  }
  ms.total = whole.lap();
  Json json = result_json(options, result, sizes, ms);
  if (global) add_global(*global, &json);
  if (!options.truth.empty()) add_truth(source, result.target_from_source, truth, &json);
  if (!options.output.empty()) write_cloud(options.output, moved(source, result.target_from_source));
  if (!options.picture.empty()) {
    write_file_bytes(options.picture,
                     alignment_svg({moved(source, given), moved(source, result.target_from_source), target,
                                    options.method}));
  }
  print_result(json, options.json);
  return judge(global ? verdict_of(global->registration) : verdict_of(result), options.accept);
}

RunFiles files_of(const AlignOptions& options) {
  RunFiles files{{options.source, options.target, options.init, options.truth},
                 {options.output, options.picture, options.poses},
                 ""};
  files.inputs.insert(files.inputs.end(), options.more.begin(), options.more.end());
  return files;
}

int align(AlignOptions& options) {
  settle_align_options(options);
  check_outputs(files_of(options), options.force);
  if (!options.output.empty()) check_cloud_path(options.output);
  check_picture_path(options.picture);
  if (!options.chain) return run(options);
  run_chain(options);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (wants_matches(argc, argv)) return align_matches(argc, argv);
  return run_program<AlignOptions>("scanlock-align", "Aligns SOURCE to TARGET.", argc, argv,
                                   declare_align_options, align);
}
