// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-evaluate: the errors of a trajectory as numbers and as a picture.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "evaluation/log_states.hpp"
#include "evaluation/report.hpp"
#include "io/file_bytes.hpp"
#include "io/output_files.hpp"
#include "io/trajectory_source.hpp"

namespace {

using namespace scanlock;
using Json = nlohmann::ordered_json;

struct Options {
  std::string estimate, reference, picture, html;
  std::string align = "se3";
  std::vector<std::string> notes;
  double tolerance_s = kDefaultTimeTolerance;
  bool json = false, force = false;
};

constexpr const char* kFooter =
    R"(ESTIMATE and REFERENCE: a TUM file (time x y z qx qy qz qw), a KITTI file (12 numbers a line), LOG:CHANNEL, or an
LCM log alone for its channel POSE_BODY_CORRECTED.

Poses are matched by time: each estimate with the reference nearest to it, not farther than --tolerance.
Where either side is a KITTI file, which has no times, the n-th pose is matched with the n-th.

--align se3    aligns the estimate with the reference by the best rigid motion (Umeyama without scale), as evo -a does
--align yaw    aligns it by a translation and a rotation about z only
--align none   does not align it: both trajectories must be given in the same frame

RPE over a length: from each pose to the first one at least this length further along the path of the reference; mean over
all poses, percent and deg/m.
Kidnaps are jumps of the reference that are too large for a motion. Errors while tracking are those of poses with the state
TRACKING or DEGRADED (of all poses if the states are not known) that do not lie between a kidnap and its recovery, aligned by
these poses only; their RPE is over stretches that contain no other pose. recovery_s: seconds from each kidnap to the first
pose from which on the estimate stays within 1 m and 5 degrees for a second in state TRACKING or DEGRADED; null: never. For
this, the estimate is aligned by positions and orientations before the first kidnap. wrong_jumps: number of jumps in state
TRACKING to a pose that is wrong by more than 2 m; null for an estimate without scanlock.odometry_t on SCANLOCK_ODOMETRY.
NEES: normalised estimation error squared, e^T C^-1 e, of the poses and covariances C of scanlock.odometry_t on
SCANLOCK_ODOMETRY; mean over the selected poses (6 if the covariances are right) and share beyond 16.81, the 99 % bound of
chi-square with 6 degrees of freedom. e = log((first_truth^-1 truth)^-1 (first_estimate^-1 estimate)), [translation;
rotation] in the body frame. Selected are poses with the state TRACKING or DEGRADED before the first kidnap and the first
change of epoch, one every 5 m of that path, or every 50 m if it is longer than 200 m. If all of them list z, roll and pitch
as degenerate (planar sensor), only x, y and yaw count: 3 and 11.34. nees: null if ESTIMATE is not a log or has no
covariances; its mean: null (infinite) if a covariance is not positive definite.
KITTI: stretches of 100 to 800 m from every tenth pose, averaged as in the development kit.)";

void declare(CommandLine line, Options& options) {
  line.explain(kFooter, {"scanlock-evaluate poses.tum truth.tum --html report.html",
                         "scanlock-evaluate poses.lcmlog:SCANLOCK_LOCAL_POSE truth.tum --align yaw --json"});
  line.option("ESTIMATE", options.estimate, "the estimated trajectory").required();
  line.option("REFERENCE", options.reference, "the reference trajectory, for example the truth").required();
  line.option("--align", options.align, "how the estimate is aligned with the reference (default: se3)")
      .one_of({"none", "yaw", "se3"});
  line.option("--tolerance", options.tolerance_s,
              "largest time difference of two matched poses, seconds (default: 0.01)")
      .above_zero();
  line.option("--picture", options.picture, "write an SVG picture here");
  line.option("--html", options.html, "write a page with the picture and the numbers here");
  line.option("--note", options.notes,
              "NAME: VALUE, a further row of the table and of the page; may be repeated")
      .repeated();
  line.flag("--force", options.force, "overwrite outputs that are there already");
  line.flag("--json", options.json, "print one JSON object");
}

LoadedTrajectory load(const std::string& source) {
  LoadedTrajectory loaded = load_trajectory(source);
  if (!loaded.warning.empty()) std::cerr << "scanlock-evaluate: " << source << ": " << loaded.warning << "\n";
  return loaded;
}

Overlay overlay_of(const Options& options) {
  if (options.align == "none") return Overlay::kNone;
  return options.align == "yaw" ? Overlay::kYaw : Overlay::kSe3;
}

PosePairs match(const LoadedTrajectory& estimate, const LoadedTrajectory& reference, const Options& options) {
  if (estimate.has_times && reference.has_times) {
    PosePairs pairs = match_by_time(estimate.trajectory, reference.trajectory, options.tolerance_s);
    if (!pairs.empty()) return pairs;
    throw std::runtime_error(options.estimate + ": none of its poses (the first at " +
                             std::to_string(estimate.trajectory.front().time_s) + " s) lies within " +
                             std::to_string(options.tolerance_s) + " s of a pose of " + options.reference +
                             " (the first at " + std::to_string(reference.trajectory.front().time_s) +
                             " s); do they share a clock?");
  }
  const bool same_size = estimate.trajectory.size() == reference.trajectory.size();
  if (!same_size && estimate.has_times != reference.has_times)
    throw std::runtime_error(options.estimate + " and " + options.reference + ": one has no times, and " +
                             std::to_string(estimate.trajectory.size()) + " poses cannot be matched with " +
                             std::to_string(reference.trajectory.size()) + " by number; use TUM files");
  if (!same_size)
    std::cerr << "scanlock-evaluate: " << estimate.trajectory.size() << " poses against "
              << reference.trajectory.size() << "; matched by number from the first on\n";
  return match_by_number(estimate.trajectory, reference.trajectory);
}

Json absolute_json(const AbsoluteError& error) {
  return {{"rmse", error.rmse}, {"median", error.median}, {"max", error.max}};
}

Json relative_json(const std::optional<RelativeError>& error) {
  if (!error) return {{"percent", nullptr}, {"deg_per_m", nullptr}};
  return {{"percent", error->percent}, {"deg_per_m", error->deg_per_m}};
}

template <typename RelativeErrors>
Json rpe_json(const RelativeErrors& rpe) {
  return {{"1m", relative_json(rpe[0])}, {"10m", relative_json(rpe[1])}, {"100m", relative_json(rpe[2])}};
}

Json tracking_json(const std::optional<TrackingError>& tracking) {
  if (!tracking) return nullptr;
  return {{"poses", tracking->poses},
          {"ate_m", absolute_json(tracking->ate_m)},
          {"rpe", rpe_json(tracking->rpe)}};
}

Json kidnaps_json(const Comparison& comparison) {
  Json kidnaps = Json::array();
  for (std::size_t i = 0; i < comparison.kidnaps.kidnaps.size(); ++i) {
    const Kidnap& kidnap = comparison.kidnaps.kidnaps[i];
    const AwayError& away = comparison.split.away[i];
    kidnaps.push_back({{"at_s", kidnap.time_s - comparison.reference.front().time_s},
                       {"jump_m", kidnap.jump_m},
                       {"jump_deg", kidnap.jump_deg},
                       {"poses_until_back", away.poses},
                       {"error_until_back_m", away.ate_m ? absolute_json(*away.ate_m) : Json(nullptr)}});
  }
  return kidnaps;
}

Json nees_json(const std::optional<Nees>& nees) {
  if (!nees) return nullptr;
  return {{"mean", nees->mean}, {"beyond_99", nees->beyond_99}, {"poses", nees->poses}, {"dof", nees->dof}};
}

Json result_json(const Comparison& comparison, const std::string& align) {
  const Evaluation& e = comparison.evaluation;
  Json recovery_s = Json::array();
  for (const Kidnap& kidnap : comparison.kidnaps.kidnaps)
    recovery_s.push_back(kidnap.recovery_s ? Json(*kidnap.recovery_s) : Json(nullptr));
  const auto& wrong = comparison.kidnaps.wrong_jumps;
  return {{"poses", e.poses},
          {"matched", e.matched},
          {"length_m", e.length_m},
          {"ate_m", absolute_json(e.ate_m)},
          {"rpe", rpe_json(e.rpe)},
          {"kitti", relative_json(e.kitti)},
          {"tracking", tracking_json(comparison.split.tracking)},
          {"nees", nees_json(comparison.nees)},
          {"kidnaps", kidnaps_json(comparison)},
          {"wrong_jumps", wrong ? Json(*wrong) : Json(nullptr)},
          {"recovery_s", recovery_s},
          {"align", align}};
}

Rows notes_of(const Options& options) {
  Rows notes;
  for (const std::string& note : options.notes) {
    const std::size_t colon = note.find(": ");
    if (colon == std::string::npos) throw UsageError("--note " + note + ": is not NAME: VALUE");
    notes.push_back({note.substr(0, colon), note.substr(colon + 2)});
  }
  return notes;
}

int run(const Options& options) {
  const Rows notes = notes_of(options);
  check_outputs({{trajectory_file(options.estimate), trajectory_file(options.reference)},
                 {options.picture, options.html},
                 ""},
                options.force);
  check_picture_path(options.picture);
  const LoadedTrajectory estimate = load(options.estimate);
  LoadedTrajectory reference = load(options.reference);
  if (reference.has_times) sort_by_time(reference.trajectory);
  Comparison comparison;
  comparison.estimate_name = estimate.name;
  comparison.reference_name = reference.name;
  comparison.estimate = estimate.trajectory;
  comparison.reference = reference.trajectory;
  comparison.notes = notes;
  comparison.pairs = match(estimate, reference, options);
  comparison.evaluation = evaluate(comparison.pairs, estimate.trajectory.size(), overlay_of(options));
  if (estimate.has_times && reference.has_times) {
    comparison.states = load_states(options.estimate);
    comparison.kidnaps =
        examine_kidnaps(comparison.reference, comparison.pairs, comparison.states, overlay_of(options));
    comparison.nees =
        normalised_error(comparison.pairs, comparison.states, first_kidnap_s(comparison.kidnaps.kidnaps));
  }
  comparison.split =
      split_errors(comparison.pairs, comparison.states, comparison.kidnaps, overlay_of(options));
  const PosePair& first = comparison.pairs.front();
  const double apart = (first.estimate.translation() - first.reference.translation()).norm();
  if (overlay_of(options) == Overlay::kNone && apart > 1)
    std::cerr << "scanlock-evaluate: the trajectories begin " << apart
              << " m apart; if they are given in two frames, use --align se3 (or yaw)\n";
  if (!options.picture.empty()) write_file_bytes(options.picture, trajectory_svg(comparison));
  if (!options.html.empty()) write_file_bytes(options.html, trajectory_html(comparison));
  if (options.json) {
    print_json(result_json(comparison, options.align));
    return 0;
  }
  std::printf("%-20s %s\n", "aligned by", options.align.c_str());
  for (const auto& [what, value] : result_rows(comparison))
    std::printf("%-20s %s\n", what.c_str(), value.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<Options>("scanlock-evaluate", "Trajectory errors as numbers and as a picture.", argc,
                              argv, declare, run);
}
