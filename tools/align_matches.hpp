// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-align --correspondences: the 4DOF solver on a file of matches.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "align_report.hpp"
#include "geometry/angles.hpp"
#include "global/cpu_clock.hpp"
#include "global/match_ransac.hpp"
#include "global/match_registration.hpp"
#include "io/match_file.hpp"
#include "io/progress_bar.hpp"

namespace scanlock {

struct AlignMatchesOptions {
  std::string file;
  std::vector<double> up = {0, 0, 1};
  double tilt_degrees = 0;
  int threads = 1;
  bool no_pruning = false, ransac = false, json = false;
  MatchRegistrationOptions registration;
};

/// Whether the command line asks for this instead of for clouds.
inline bool wants_matches(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], "--correspondences", std::strlen("--correspondences")) == 0) return true;
  }
  return false;
}

/// -1 to go on, else the exit code.
inline int parse_align_matches(int argc, char** argv, AlignMatchesOptions& options) {
  CLI::App app{"Finds the levelled motion that holds most matches, with proof."};
  app.footer("FILE: one match a line, px py pz qx qy qz, metres; # starts a comment.");
  app.set_version_flag("-V,--version", std::string("scanlock-align ") + SCANLOCK_VERSION);
  app.add_option("--correspondences", options.file, "the candidate matches")->required();
  app.add_option("--epsilon", options.registration.epsilon, "largest residual of an inlier, metres")
      ->required();
  app.add_flag("--no-pruning", options.no_pruning, "search all matches");
  app.add_option("--budget", options.registration.budget_s,
                 "end after so many seconds, with the gap that remains (default: none)");
  app.add_option("--up", options.up, "the axis of rotation X,Y,Z (default: 0,0,1)")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--tilt", options.tilt_degrees,
                 "gravity is known to so many degrees in either cloud (default: 0)");
  app.add_flag("--ransac", options.ransac, "for comparison: RANSAC with samples of two matches; no proof");
  app.add_option("--threads", options.threads, "taken for uniformity; the search runs in one thread")
      ->check(CLI::Range(1, 256).description(""));
  app.add_flag("--json", options.json, "print one JSON object");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const auto wrong = [](const std::string& sentence) {
    std::cerr << "scanlock-align: " << sentence << "\n";
    return 2;
  };
  options.registration.prune = !options.no_pruning;
  options.registration.up = {options.up[0], options.up[1], options.up[2]};
  options.registration.tilt = options.tilt_degrees * kDegree;
  if (!(options.registration.epsilon > 0) || !std::isfinite(options.registration.epsilon))
    return wrong("--epsilon: must be a number of metres above 0");
  if (!(options.registration.budget_s >= 0)) return wrong("--budget: must be 0 seconds or more");
  if (!options.registration.up.allFinite() || !(options.registration.up.norm() > 0))
    return wrong("--up: must be a vector other than 0,0,0");
  if (options.ransac && (options.tilt_degrees != 0 || options.registration.up != Eigen::Vector3d::UnitZ()))
    return wrong("--ransac: takes no --tilt and no --up");
  if (!(options.tilt_degrees >= 0 && options.tilt_degrees <= 20))
    return wrong("--tilt: must be 0 to 20 degrees");
  return -1;
}

inline Json align_matches_json(const MatchRegistration& found, const MatchRegistrationOptions& options,
                               double read_ms, double total_ms) {
  return {{"method", "4dof"},
          {"transform", row_major(found.target_from_source.matrix())},
          {"points", {found.matches, found.matches}},
          {"iterations", found.nodes},
          {"stop_reason", found.certified ? "certified" : "budget"},
          {"inlier_ratio", static_cast<double>(found.consensus) / static_cast<double>(found.matches)},
          {"epsilon", options.epsilon},
          {"tilt_deg", options.tilt / kDegree},
          {"matches", found.matches},
          {"matches_after_pruning", found.matches_after_pruning},
          {"consensus", found.consensus},
          {"upper_bound", found.upper_bound},
          {"certified", found.certified},
          {"runner_up_consensus", found.runner_up_consensus},
          {"runner_up_bound", found.runner_up_bound},
          {"runner_up_transform", row_major(found.runner_up.matrix())},
          {"nodes", found.nodes},
          {"inliers", found.inliers},
          {"ms",
           {{"read", read_ms},
            {"keypoints", 0},
            {"features", 0},
            {"matching", 0},
            {"pruning", found.pruning_ms},
            {"search", found.search_ms},
            {"runner_up", found.runner_up_ms},
            {"solve", found.pruning_ms + found.search_ms + found.runner_up_ms},
            {"total", total_ms}}},
          {"peak_rss_mb", peak_rss_mb()}};
}

/// The baseline, in the shape of the solver's answer: nothing proven, all of its time in the search.
inline MatchRegistration ransac_baseline(const Matches& matches, double epsilon) {
  MatchRansacOptions options;
  options.epsilon = epsilon;
  CpuClock clock;
  const MatchRansac found = ransac_matches(matches, options);
  MatchRegistration result;
  result.matches = result.matches_after_pruning = matches.size();
  result.target_from_source = found.target_from_source;
  result.consensus = found.consensus;
  result.upper_bound = static_cast<int>(matches.size());
  result.nodes = found.samples;
  result.search_ms = clock.lap();
  return result;
}

/// The whole program; returns its exit code.
inline int align_matches(int argc, char** argv) {
  AlignMatchesOptions options;
  const int exit_code = parse_align_matches(argc, argv, options);
  if (exit_code >= 0) return exit_code;
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  try {
    const Clock::time_point start = Clock::now();
    const Matches matches = read_matches(options.file);
    const double read_ms = since(start);
    ProgressBar bar("scanlock-align: consensus found, of what may be");
    options.registration.progress = [&](int consensus, int upper_bound) {
      bar.update(static_cast<std::uint64_t>(consensus), static_cast<std::uint64_t>(upper_bound));
    };
    MatchRegistration found;
    try {
      found = options.ransac ? ransac_baseline(matches, options.registration.epsilon)
                             : register_matches(matches, options.registration);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(options.file + ": " + error.what());
    }
    Json json = align_matches_json(found, options.registration, read_ms, since(start));
    if (options.ransac) json["stop_reason"] = "samples";
    print_result(json, options.json);
  } catch (const std::exception& error) {
    std::cerr << "scanlock-align: " << error.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace scanlock
