// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Aligns two clouds.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "align_global.hpp"
#include "align_matches.hpp"
#include "evaluation/alignment_picture.hpp"
#include "geometry/voxel_grid.hpp"
#include "icp/cloud_alignment.hpp"
#include "icp/cloud_chain.hpp"
#include "icp/cloud_thinning.hpp"
#include "io/cloud_file.hpp"
#include "io/file_bytes.hpp"
#include "io/progress_bar.hpp"
#include "io/trajectory.hpp"

namespace {

using namespace scanlock;
using Json = nlohmann::ordered_json;

struct Options {
  std::string source, target, init, truth, output, picture, poses;
  std::vector<std::string> more;  // clouds of a chain, beyond the second
  std::string method;             // empty: not given
  std::vector<double> up = {0, 0, 1};
  double epsilon = 0;
  double voxel = -1;  // negative: not given
  double nu_max = 0, nu_min = 0;
  int threads = 1;
  bool thorough = false, chain = false, json = false;
};

struct Milliseconds {
  double read = 0, normals = 0, index = 0, solve = 0, total = 0;
};

class Stopwatch {
 public:
  /// Milliseconds since the last lap.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

constexpr const char* kFooter =
    R"(SOURCE and TARGET: .ply, .pcd, .bin (KITTI) or .xyz/.txt. T.txt: 4x4, row-major text; maps source into target coordinates.
Normals of .ply and .pcd files are used; where they are missing they are estimated.

icp, aa-icp, fast-icp                      squared distances; plain, accelerated by Euler angles, accelerated in se(3)
4dof                                       no start needed, clouds levelled: the rotation about --up and the translation
                                           that most matches of features agree on, with its proof, checked with the clouds
4dof+robust-icp, 4dof+robust-icp-plane     the same, refined; the former is the default without --init and --chain
robust-icp                                 Welsch's function, nu falling from 3 medians to the sampling of the target
icp-plane, fast-icp-plane, robust-icp-plane   the same with distances to tangent planes
symmetric-icp, robust-symmetric-icp        the same with the normals of both clouds

scanlock-align --correspondences FILE --epsilon METRES solves a file of candidate matches instead; see its --help.)";

int usage(int argc, char** argv, Options& options) {
  CLI::App app{"Aligns SOURCE to TARGET."};
  app.footer(kFooter);
  app.set_version_flag("-V,--version", std::string("scanlock-align ") + SCANLOCK_VERSION);
  app.add_option("SOURCE", options.source, "the cloud to move")->required();
  app.add_option("TARGET", options.target, "the cloud to move it to")->required();
  app.add_option("MORE", options.more, "with --chain: further clouds");
  app.add_flag("--chain", options.chain,
               "register each cloud to the one before it; --output is the map, thinned like the clouds");
  app.add_option("--poses", options.poses,
                 "with --chain: write the poses here, TUM, stamped 0, 1, 2, ..., in the frame of the first");
  app.add_option("--method", options.method,
                 "see below (default: 4dof+robust-icp; with --init or --chain: robust-icp-plane)");
  app.add_option("--init", options.init, "start from this transform (default: identity)");
  app.add_option("--truth", options.truth, "compare the result with this transform");
  app.add_option("--voxel", options.voxel,
                 "thin both clouds to a point a voxel of so many metres; 0: all points (default: by itself)")
      ->check(CLI::NonNegativeNumber.description(""));
  app.add_option("--up", options.up, "4dof: the vertical of both clouds (default: 0,0,1)")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--epsilon", options.epsilon, "4dof: inlier threshold, metres (default: from the voxel)")
      ->check(CLI::PositiveNumber.description(""));
  app.add_option("--nu-max", options.nu_max, "first scale, metres (default: three times the median residual)")
      ->check(CLI::PositiveNumber.description(""));
  app.add_option("--nu-min", options.nu_min, "last scale, metres (default: from the sampling of the target)")
      ->check(CLI::PositiveNumber.description(""));
  app.add_flag("--thorough", options.thorough,
               "use all points and the final tolerance at every scale, as the paper does");
  app.add_option("--threads", options.threads, "threads; the result does not depend on them (default: 1)")
      ->check(CLI::Range(1, 256).description(""));
  app.add_option("--output", options.output, "write the aligned source here");
  app.add_option("--picture", options.picture, "write an SVG picture here");
  app.add_flag("--json", options.json, "print one JSON object");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (options.method.empty())
    options.method = options.init.empty() && !options.chain ? "4dof+robust-icp" : "robust-icp-plane";
  for (const auto& [wrong, words] :
       {std::pair{options.chain && is_global(options.method), "the methods of 4dof do not go with --chain"},
        std::pair{is_global(options.method) && !options.init.empty(), "the methods of 4dof take no --init"},
        std::pair{Eigen::Vector3d(options.up.data()).norm() < 1e-9, "--up must not be 0,0,0"},
        std::pair{!options.chain && !options.more.empty(), "more than two clouds go with --chain"},
        std::pair{!options.chain && !options.poses.empty(), "--poses goes with --chain"},
        std::pair{options.chain && !(options.init + options.truth + options.picture).empty(),
                  "--init, --truth and --picture do not go with --chain"}}) {
    if (!wrong) continue;
    std::cerr << "scanlock-align: " << words << "\n";
    return 2;
  }
  const std::string refining = refining_method(options.method);
  if (refining.empty() || find_cloud_method(refining)) return -1;
  std::string names = " 4dof 4dof+robust-icp 4dof+robust-icp-plane";
  for (const std::string& name : cloud_method_names()) names += " " + name;
  std::cerr << "scanlock-align: --method " << options.method << " is not known here; known are" << names
            << "\n";
  return 2;
}

Pose read_transform(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  Eigen::Matrix4d m;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      if (!(file >> m(row, column)) || !std::isfinite(m(row, column)))
        throw std::runtime_error(path + ": row " + std::to_string(row + 1) + ", number " +
                                 std::to_string(column + 1) +
                                 ": a transform is 16 numbers, four rows of four");
    }
  }
  const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  if ((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3 || r.determinant() < 0 ||
      (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 1e-9)
    throw std::runtime_error(
        path + ": not a rigid transform (rows of R are not orthonormal, or the last row is not 0 0 0 1)");
  Pose pose = Pose::Identity();
  pose.linear() = r;
  pose.translation() = m.topRightCorner<3, 1>();
  return renormalised(pose);
}

PointCloud moved(const PointCloud& cloud, const Pose& pose) {
  PointCloud result = cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p = (pose * cloud.point(i).cast<double>()).cast<float>();
    result.x[i] = p.x();
    result.y[i] = p.y();
    result.z[i] = p.z();
    if (!cloud.has_normals()) continue;
    const Eigen::Vector3f n = (pose.linear() * cloud.normal(i).cast<double>()).cast<float>();
    result.nx[i] = n.x();
    result.ny[i] = n.y();
    result.nz[i] = n.z();
  }
  return result;
}

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

double peak_rss_mb() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) / 1024.0;
}

Json row_major(const Eigen::MatrixXd& matrix) {
  Json values = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) values.push_back(matrix(r, c));
  }
  return values;
}

Json axis_names(std::uint32_t axes) {
  constexpr const char* kNames[] = {"x", "y", "z", "rx", "ry", "rz"};
  Json names = Json::array();
  for (int bit = 0; bit < 6; ++bit) {
    if (axes >> bit & 1u) names.push_back(kNames[bit]);
  }
  return names;
}

Json result_json(const Options& options, const CloudAlignment& result, std::size_t source, std::size_t target,
                 double voxel, const Milliseconds& ms) {
  return {{"method", options.method},
          {"transform", row_major(result.target_from_source.matrix())},
          {"points", {source, target}},
          {"voxel", voxel},
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
  (*json)["rotation_error_deg"] = so3_log(error.linear()).norm() * 180.0 / 3.14159265358979323846;
  (*json)["translation_error"] = (found.translation() - truth.translation()).norm();
}

void print(const Options& options, const Json& json) {
  if (options.json) {
    std::cout << json.dump() << "\n";
    return;
  }
  const auto& t = json["transform"];
  for (std::size_t row = 0; row < 4; ++row) {
    std::printf("%.9g %.9g %.9g %.9g\n", t[4 * row].get<double>(), t[4 * row + 1].get<double>(),
                t[4 * row + 2].get<double>(), t[4 * row + 3].get<double>());
  }
  for (const auto& [key, value] : json.items()) {
    if (key != "transform" && key != "covariance") std::cerr << key << ": " << value.dump() << "\n";
  }
}

CloudTarget make_target(const Options& options, const PointCloud& cloud) {
  try {
    return CloudTarget(cloud, options.threads);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(options.target + ": " + error.what());
  }
}

CloudAlignmentOptions alignment_options(const Options& options) {
  CloudAlignmentOptions alignment;
  alignment.nu_max = options.nu_max;
  alignment.nu_min = options.nu_min;
  alignment.thorough = options.thorough;
  alignment.threads = options.threads;
  return alignment;
}

void append(const PointCloud& cloud, PointCloud* map) {
  map->x.insert(map->x.end(), cloud.x.begin(), cloud.x.end());
  map->y.insert(map->y.end(), cloud.y.begin(), cloud.y.end());
  map->z.insert(map->z.end(), cloud.z.begin(), cloud.z.end());
}

void run_chain(const Options& options) {
  Stopwatch whole;
  std::vector<std::string> paths = {options.source, options.target};
  paths.insert(paths.end(), options.more.begin(), options.more.end());
  CloudChain chain(*find_cloud_method(options.method), alignment_options(options),
                   options.voxel >= 0 ? std::optional<double>(options.voxel) : std::nullopt);
  std::optional<ProgressBar> bar(std::in_place, "aligning");
  PointCloud map;
  Trajectory trajectory;
  Json links = Json::array();
  double length = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    PointCloud cloud = read_cloud(paths[i]);
    std::optional<CloudAlignment> link;
    try {
      link = chain.add(cloud);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(paths[i] + ": " + error.what());
    }
    trajectory.push_back({static_cast<double>(i), chain.poses().back()});
    if (!options.output.empty()) append(moved(thinned_by(cloud, chain.voxel()), chain.poses().back()), &map);
    bar->update(i + 1, paths.size());
    if (!link) continue;
    length += link->target_from_source.translation().norm();
    links.push_back({{"source", paths[i]},
                     {"target", paths[i - 1]},
                     {"transform", row_major(link->target_from_source.matrix())},
                     {"stop_reason", link->stop_reason},
                     {"inlier_ratio", link->inlier_ratio},
                     {"degenerate_axes", axis_names(link->degenerate_axes)}});
  }
  bar.reset();
  if (!options.poses.empty()) write_tum(options.poses, trajectory);
  // Where clouds overlap, one point a voxel is enough.
  if (!options.output.empty()) write_cloud(options.output, thinned_by(map, chain.voxel()));
  const Json json = {
      {"method", options.method}, {"clouds", paths.size()},         {"length", length},
      {"links", links},           {"ms", {{"total", whole.lap()}}}, {"peak_rss_mb", peak_rss_mb()}};
  if (options.json) {
    std::cout << json.dump() << "\n";
    return;
  }
  for (const StampedPose& stamped : trajectory) {
    const Eigen::Vector3d t = stamped.pose.translation();
    const Eigen::Quaterniond q(stamped.pose.linear());
    std::printf("%.0f %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", stamped.time_s, t.x(), t.y(), t.z(), q.x(),
                q.y(), q.z(), q.w());
  }
  for (const auto& link : links) {
    if (link["stop_reason"] != "converged")
      std::cerr << link["source"].get<std::string>() << ": " << link["stop_reason"].get<std::string>()
                << "\n";
  }
}

void run(const Options& options) {
  const std::string refining = refining_method(options.method);
  const CloudMethod method = refining.empty() ? CloudMethod{} : *find_cloud_method(refining);
  Stopwatch whole, watch;
  Milliseconds ms;
  PointCloud source_file = read_cloud(options.source), target_file = read_cloud(options.target);
  Pose start = options.init.empty() ? Pose::Identity() : read_transform(options.init);
  ms.read = watch.lap();
  std::optional<GlobalStart> global;
  if (is_global(options.method)) {
    global = find_global_start(source_file, target_file, Eigen::Vector3d(options.up.data()), options.voxel,
                               options.epsilon);
    if (refining.empty() || global->found()) start = global->pose(!refining.empty());
  }
  const double global_ms = watch.lap();
  if (options.output.empty()) source_file.intensity = {};
  target_file.intensity = {};
  const double voxel = options.voxel >= 0 ? options.voxel : sensible_voxel(target_file);
  const PointCloud thin_source = voxel > 0 ? thinned_by(source_file, voxel) : PointCloud{};
  const PointCloud thin_target = voxel > 0 ? thinned_by(target_file, voxel) : PointCloud{};
  const PointCloud& source = voxel > 0 ? thin_source : source_file;
  const PointCloud& target_cloud = voxel > 0 ? thin_target : target_file;
  CloudTarget target = make_target(options, target_cloud);
  const std::size_t target_points = target_cloud.size();
  if (options.picture.empty()) target_file = PointCloud{};  // the target has its own copy
  ms.index = watch.lap();
  if (method.needs_normals()) target.prepare_normals(options.threads);
  ms.normals = watch.lap();
  CloudAlignmentOptions alignment = alignment_options(options);
  alignment.voxel = voxel;
  std::optional<ProgressBar> bar(std::in_place, "aligning");
  alignment.progress = [&](double share) { bar->update(static_cast<std::uint64_t>(1000 * share), 1000); };
  if (global && global->found() && !(options.nu_max > 0)) alignment.nu_max = global->registration.epsilon;
  CloudAlignment result;
  try {
    if (refining.empty()) {
      result.target_from_source = start;
      result.stop_reason = verdict_name(global->registration.verdict);
    } else {
      result = align_clouds(source, target, start, method, alignment);
    }
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(options.source + ": " + error.what());
  }
  bar.reset();
  ms.solve = global_ms + watch.lap();
  ms.total = whole.lap();
  Json json = result_json(options, result, source.size(), target_points, voxel, ms);
  if (global) add_global(*global, &json);
  if (!options.truth.empty())
    add_truth(source_file, result.target_from_source, read_transform(options.truth), &json);
  if (!options.output.empty()) write_cloud(options.output, moved(source_file, result.target_from_source));
  if (!options.picture.empty()) {
    write_file_bytes(options.picture,
                     alignment_svg({moved(source_file, start), moved(source_file, result.target_from_source),
                                    target_file, options.method}));
  }
  print(options, json);
}

}  // namespace

int main(int argc, char** argv) {
  if (wants_matches(argc, argv)) return align_matches(argc, argv);
  Options options;
  const int exit_code = usage(argc, argv, options);
  if (exit_code >= 0) return exit_code;
  try {
    options.chain ? run_chain(options) : run(options);
  } catch (const std::exception& error) {
    std::cerr << "scanlock-align: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
