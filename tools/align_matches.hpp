// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-align --correspondences: the 4DOF solver on a file of matches.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "align_report.hpp"
#include "align_verdict.hpp"
#include "command_line.hpp"
#include "geometry/angles.hpp"
#include "global/cpu_clock.hpp"
#include "global/match_ransac.hpp"
#include "global/max_consensus.hpp"
#include "io/match_file.hpp"
#include "io/progress_bar.hpp"

namespace scanlock {

struct AlignMatchesOptions {
  std::string file;
  std::vector<double> up = {0, 0, 1};
  double tilt_degrees = 0;
  int threads = 1;
  std::string accept = "certain";
  bool no_pruning = false, ransac = false, json = false;
  MatchRegistrationOptions registration;
};

/// Whether the command line has --correspondences, and so no clouds.
inline bool wants_matches(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], "--correspondences", std::strlen("--correspondences")) == 0) return true;
  }
  return false;
}

inline void declare_align_matches(CommandLine line, AlignMatchesOptions& options) {
  line.explain("FILE: one match a line, px py pz qx qy qz, metres; # starts a comment.",
               {"scanlock-align --correspondences matches.txt --epsilon 0.1 --json"});
  line.option("--correspondences", options.file, "file of the candidate matches").required();
  line.option("--epsilon", options.registration.epsilon, "largest residual of an inlier, metres").required();
  line.flag("--no-pruning", options.no_pruning, "search without pruning the matches first");
  line.option("--budget", options.registration.budget_s,
              "stop after this many seconds, with the remaining gap between consensus and upper bound "
              "(default: no limit)");
  line.option("--up", options.up, "the axis of rotation X,Y,Z (default: 0,0,1)").comma_separated(3);
  line.option("--tilt", options.tilt_degrees,
              "largest error of the vertical in either cloud, degrees, 0 to 20 (default: 0)");
  line.flag("--ransac", options.ransac, "for comparison: RANSAC with samples of two matches; no proof");
  line.option("--threads", options.threads,
              "accepted as by the other methods; this search runs in one thread")
      .within(1, 256);
  add_accept_option(line, options.accept,
                    "any: exit 0 also where the answer is not certified (default: certain)");
  line.flag("--json", options.json, "print one JSON object");
}

/// Sets the members that follow from other options; throws UsageError for values that are not allowed.
inline void settle_align_matches(AlignMatchesOptions& options) {
  options.registration.prune = !options.no_pruning;
  options.registration.up = {options.up[0], options.up[1], options.up[2]};
  options.registration.tilt = options.tilt_degrees * kDegree;
  if (!(options.registration.epsilon > 0) || !std::isfinite(options.registration.epsilon))
    throw UsageError("--epsilon: must be a number of metres above 0");
  if (!(options.registration.budget_s >= 0)) throw UsageError("--budget: must be 0 seconds or more");
  if (!options.registration.up.allFinite() || !(options.registration.up.norm() > 0))
    throw UsageError("--up: must be a vector other than 0,0,0");
  if (options.ransac && (options.tilt_degrees != 0 || options.registration.up != Eigen::Vector3d::UnitZ()))
    throw UsageError("--ransac: cannot be used with --tilt or --up");
  if (!(options.tilt_degrees >= 0 && options.tilt_degrees <= 20))
    throw UsageError("--tilt: must be 0 to 20 degrees");
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

/// The result of RANSAC in the form of the solver's answer: without a certificate, and with all of the time
/// as search time.
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

inline AlignVerdict verdict_of(const MatchRegistration& found) {
  if (found.certified) return {};
  return {Acceptance::kAny, "not certified: the consensus is " + std::to_string(found.consensus) +
                                ", its upper bound " + std::to_string(found.upper_bound)};
}

inline int solve_matches(AlignMatchesOptions& options) {
  settle_align_matches(options);
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  const Clock::time_point start = Clock::now();
  const Matches matches = read_matches(options.file);
  const double read_ms = since(start);
  ProgressBar bar("scanlock-align: consensus, of its upper bound");
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
  return judge(verdict_of(found), options.accept);
}

/// The whole program; returns its exit code.
inline int align_matches(int argc, char** argv) {
  return run_program<AlignMatchesOptions>("scanlock-align",
                                          "Finds the rotation about the vertical and the translation with "
                                          "the most inlier matches, with a certificate.",
                                          argc, argv, declare_align_matches, solve_matches);
}

}  // namespace scanlock
