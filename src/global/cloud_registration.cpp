// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "global/attitude_search.hpp"
#include "global/cloud_pair.hpp"
#include "global/cpu_clock.hpp"
#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

constexpr double kEpsilonOfVoxel = 0.75;
constexpr double kStrongOverlap = 0.55, kStrongLeastOverlap = 0.45;
constexpr std::uint32_t kHorizontalAxes = 1u | 2u | 32u;  // x, y, yaw
constexpr double kNoRival = 2;                            // consensus over the bound of the runner-up
constexpr int kPreciseMatches = 24;
// Enough attempts find a plausible pose by chance: results of later match sets have to pass both tests.
constexpr int kPlainAttempts = 2;
constexpr int kPeels = 4;  // rounds of sequential consensus
constexpr std::size_t kProposals = 8;
constexpr std::size_t kFewAttitudes = 4;  // to search in more attitudes takes long
constexpr double kSpread = 0.08;          // radians between attitudes that change a coarse score
constexpr double kPeeled = 2;             // epsilons
constexpr double kOutOfQuestion = 0.4;    // score below that of the best hypothesis
constexpr double kFarAhead = 1.6;         // consensus over the bound of the runner-up
constexpr std::size_t kManyKeypoints = 300;

std::string no_pose_has_enough(const MatchRegistration& search) {
  const std::string enough =
      std::to_string(kFewestMatches) + " of " + std::to_string(search.matches) + " matches";
  if (search.upper_bound < kFewestMatches) return "no pose has " + enough;
  return "no pose with " + enough + " was found, and it is not proven that none exists";
}

/// A subset of the directions such that each direction is within kSpread of one of the subset.
std::vector<Eigen::Vector3d> spread_out(const std::vector<Eigen::Vector3d>& directions) {
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& direction : directions) {
    const auto near = [&](const Eigen::Vector3d& other) { return (direction - other).norm() < kSpread; };
    if (std::none_of(result.begin(), result.end(), near)) result.push_back(direction);
  }
  return result;
}

bool is_good(const Hypothesis& hypothesis) {
  return hypothesis.fit.contradiction <= kClearContradiction && hypothesis.fit.overlap >= kSomeOverlap;
}

/// One registration: its searches, and the decision between the poses that they find.
class Registrar {
 public:
  Registrar(const CloudDescription& source, const CloudDescription& target,
            const CloudRegistrationOptions& options, const CloudCheck* target_check)
      : source_(source),
        target_(target),
        options_(options),
        epsilon_(options.epsilon > 0 ? options.epsilon : kEpsilonOfVoxel * source.voxel),
        clouds_(source, target, epsilon_, options.judged, target_check) {}

  CloudRegistration run();

 private:
  CloudRegistration decide();
  CloudRegistration propose();
  void try_again();
  void attempt(const CloudDescription& source, const CloudDescription& target);
  MatchRegistration search(const Matches& matches, bool runner_up, int at_least = 0) const;
  void look_for_more(Matches matches);
  auto good_ones() const { return std::count_if(hypotheses_.begin(), hypotheses_.end(), is_good); }
  int fewest_of_a_rival() const;
  void add_hypothesis(const Pose& pose, int consensus);
  void settle_on(const Hypothesis& best);
  void account(const MatchRegistration& search) {
    result_.pruning_ms += search.pruning_ms;
    result_.search_ms += search.search_ms + search.runner_up_ms;
    result_.nodes += search.nodes;
    work_ += search.work;
  }
  void judge();
  std::string numbers() const;

  const CloudDescription &source_, &target_;
  CloudRegistrationOptions options_;
  double epsilon_;  // metres
  CloudPair clouds_;
  std::vector<Hypothesis> hypotheses_;  // of this attempt; distinct; the first has the largest consensus
  CloudRegistration result_;
  std::size_t work_ = 0;  // of all searches
};

MatchRegistration Registrar::search(const Matches& matches, bool runner_up, int at_least) const {
  MatchRegistrationOptions search;
  search.at_least = at_least;
  search.epsilon = epsilon_;
  search.tilt = options_.tilt;
  search.max_nodes = options_.max_nodes;
  search.max_work = options_.max_work - std::min(options_.max_work, work_);
  search.budget_s = options_.budget_s;
  search.runner_up = runner_up;
  search.prune = runner_up;                  // without a runner-up, pruning saves no time
  search.weak_runner_up = !options_.judged;  // if judged, the clouds exclude weak ones
  search.runner_up_distance = kRunnerUpEpsilons * epsilon_;
  search.runner_up_angle = kRivalAngle;
  return search_attitudes(matches, search, options_.target_ups, clouds_.centre());
}

/// Adds the pose as a hypothesis, unless a hypothesis with about the same refined pose exists.
void Registrar::add_hypothesis(const Pose& pose, int consensus) {
  const Hypothesis hypothesis = clouds_.examine(pose, consensus, hypotheses_.empty());
  const bool known = std::any_of(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& other) {
    return clouds_.separation(other.refined, hypothesis.refined) < 0.5;
  });
  if (!known) hypotheses_.push_back(hypothesis);
}

void Registrar::settle_on(const Hypothesis& best) {
  result_.start = best.start;
  result_.target_from_source = best.refined;
  result_.fit = best.fit;
  result_.degenerate_axes = best.degenerate_axes;
}

/// Sequential consensus, because among ambiguous matches the right pose need not hold most of them: removes
/// the matches of the poses found so far, and searches the remaining ones, repeatedly. The matches of a pose
/// as it was found are removed, too: its refinement may have led to a hypothesis that is known already.
void Registrar::look_for_more(Matches matches) {
  std::vector<Pose> found = {result_.solution.target_from_source, result_.solution.runner_up};
  for (const Hypothesis& h : hypotheses_) found.push_back(h.start);
  const int fewest = options_.judged ? kFewestMatches : fewest_of_a_rival();
  for (int peel = 0; peel < kPeels; ++peel) {
    const auto agrees = [&](const Match& m) {
      const double reach = kPeeled * epsilon_ + options_.tilt * m.p.norm();
      return std::any_of(found.begin(), found.end(),
                         [&](const Pose& pose) { return (pose * m.p - m.q).norm() <= reach; });
    };
    matches.erase(std::remove_if(matches.begin(), matches.end(), agrees), matches.end());
    const MatchRegistration next = search(matches, false, options_.judged ? 0 : fewest);
    account(next);
    if (next.consensus < fewest) break;
    add_hypothesis(next.target_from_source, next.consensus);
    found = {next.target_from_source, hypotheses_.back().start};
  }
}

/// The least consensus of a runner-up: far fewer matches than the best pose that the clouds do not contradict
/// are not enough.
int Registrar::fewest_of_a_rival() const {
  int most = 0;
  for (const Hypothesis& h : hypotheses_) most = std::max(most, is_good(h) ? h.consensus : 0);
  return std::max(kFewestMatches, static_cast<int>(most / kFarAhead) + 1);
}

void Registrar::attempt(const CloudDescription& source, const CloudDescription& target) {
  CpuClock clock;
  const Matches matches = match(source, target, options_.lambda);
  result_.matching_ms += clock.lap();
  result_.solution = search(matches, true);
  account(result_.solution);
  ++result_.attempts;
  hypotheses_.clear();
  result_.start = result_.target_from_source = result_.solution.target_from_source;
  result_.fit = result_.runner_up_fit = CloudFit{};
  if (result_.solution.consensus < kFewestMatches) {
    judge();
    return;
  }
  add_hypothesis(result_.solution.target_from_source, result_.solution.consensus);
  // A runner-up with at most half the consensus cannot be right, and to compare the clouds costs more than
  // the search.
  if (result_.solution.runner_up_consensus > 0 &&
      result_.solution.consensus < kNoRival * result_.solution.runner_up_bound)
    add_hypothesis(result_.solution.runner_up, result_.solution.runner_up_consensus);
  judge();
  if (result_.verdict == GlobalVerdict::kCertain) return;
  look_for_more(matches);
  judge();
}

std::string Registrar::numbers() const {
  const MatchRegistration& s = result_.solution;
  char text[200];
  int length = std::snprintf(text, sizeof text, "%d of %zu matches agree, at any other pose at most %d",
                             s.consensus, s.matches, s.runner_up_bound);
  if (!hypotheses_.empty()) {
    std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length),
                  "; %.0f %% of the surfaces overlap, %.1f %% lie in free space", 100 * result_.fit.overlap,
                  100 * result_.fit.contradiction);
  }
  return text;
}

void Registrar::judge() {
  const MatchRegistration& s = result_.solution;
  result_.verdict = GlobalVerdict::kNoOverlap;
  if (hypotheses_.empty()) {
    result_.why = no_pose_has_enough(s);
    return;
  }
  const auto best =
      std::max_element(hypotheses_.begin(), hypotheses_.end(),
                       [](const auto& a, const auto& b) { return score(a.fit) < score(b.fit); });
  settle_on(*best);
  const bool first = best == hypotheses_.begin();
  bool runner_up = false;
  result_.runner_up_fit = CloudFit{};
  result_.runners_up.clear();
  for (const Hypothesis& h : hypotheses_) {
    if (&h == &*best) continue;
    result_.runners_up.push_back(h.refined);
    if (score(h.fit) > score(result_.runner_up_fit)) result_.runner_up_fit = h.fit;
    runner_up = runner_up || !clearly_worse(h.fit, best->fit);
  }
  const CloudFit& fit = best->fit;
  const bool sound = first && fit.contradiction <= kClearContradiction;
  const bool clear = sound && s.consensus >= kClearMargin * s.runner_up_bound;
  const bool strong = sound && fit.overlap >= kStrongOverlap && fit.least_overlap >= kStrongLeastOverlap;
  if (!confirmed(best->fit, source_.voxel)) {
    result_.why = "the clouds do not confirm any pose: " + numbers();
  } else if (runner_up) {
    result_.verdict = GlobalVerdict::kAmbiguous;
    result_.why = "another pose fits the clouds about as well: " + numbers();
  } else if ((best->degenerate_axes & kHorizontalAxes) != 0 || clouds_.slides(*best)) {
    result_.verdict = GlobalVerdict::kAmbiguous;
    result_.why = "the clouds do not constrain the pose: " + numbers();
  } else if (result_.attempts > kPlainAttempts ? !strong || !clear : !strong && !clear) {
    result_.verdict = GlobalVerdict::kAmbiguous;
    result_.why = "no pose is clearly better than the others: " + numbers();
  } else if (!s.certified) {
    result_.verdict = GlobalVerdict::kUncertified;
    result_.why =
        "the search ended before its proof (upper bound " + std::to_string(s.upper_bound) + "): " + numbers();
  } else {
    result_.verdict = GlobalVerdict::kCertain;
    result_.why = numbers();
  }
}

/// The hypotheses from matches and surfaces that the clouds do not exclude, the best score first.
CloudRegistration Registrar::propose() {
  Matches matches = clouds_.matches(options_.lambda);
  result_.solution = search(matches, true);
  account(result_.solution);
  result_.attempts = 1;
  if (result_.solution.consensus < kFewestMatches) {
    matches = clouds_.matches(kMostMatches);  // in sparse clouds hardly any match is right
    result_.solution = search(matches, true);
    account(result_.solution);
    result_.attempts = 2;
  }
  for (const Pose& pose : options_.proposals) {
    const Hypothesis proposal = clouds_.examine(pose, 0, false);
    if (proposal.fit.contradiction <= kImpossible && proposal.fit.overlap >= kSomeOverlap)
      result_.uncontradicted.push_back(proposal);
  }
  const MatchRegistration& s = result_.solution;
  if (s.consensus < kFewestMatches) {
    result_.why = no_pose_has_enough(s);
    return result_;
  }
  add_hypothesis(s.target_from_source, s.consensus);
  if (s.runner_up_consensus >= kFewestMatches) add_hypothesis(s.runner_up, s.runner_up_consensus);
  const bool few = options_.target_ups.size() <= kFewAttitudes;
  const auto add_likely = [&](const std::vector<Eigen::Vector3d>& ups) {
    for (const Pose& pose : clouds_.likely_poses(ups, kProposals)) add_hypothesis(pose, 0);
  };
  if (few) add_likely(options_.target_ups);
  const bool clear =
      s.consensus >= kFarAhead * s.runner_up_bound && is_good(hypotheses_.front()) && good_ones() == 1;
  if (!few && !clear) {
    // If the matches led to a good hypothesis, runners-up are sought in the mean direction only. Further
    // poses from matches are needed if no hypothesis is good, or if the matches led to a good one and several
    // are.
    const bool matched = good_ones() > 0;
    add_likely(matched ? std::vector<Eigen::Vector3d>{middle_of(options_.target_ups)}
                       : spread_out(options_.target_ups));
    if (good_ones() == 0 || (matched && good_ones() > 1)) look_for_more(matches);
  }
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(),
                   [](const auto& a, const auto& b) { return score(a.fit) > score(b.fit); });
  const Hypothesis& best = hypotheses_.front();
  settle_on(best);
  std::vector<CloudFit> others;
  for (const Hypothesis& h : hypotheses_) {
    if (&h == &best) continue;
    others.push_back(h.fit);
    if (score(h.fit) <= score(best.fit) - kOutOfQuestion) continue;
    if (h.fit.contradiction <= kImpossible) result_.runners_up.push_back(h.refined);
  }
  result_.log_odds = log_odds(best.fit, others);
  char odds[40];
  std::snprintf(odds, sizeof odds, "; log odds %.1f", result_.log_odds);
  result_.why = numbers() + odds;
  // Objects that move, or have moved since, contradict the right pose, too; but then no other pose is nearly
  // as good, and the log odds are positive.
  if (best.fit.contradiction > kImpossible && result_.log_odds <= 0) {
    result_.why = "the clouds contradict every pose: " + result_.why;
    return result_;
  }
  result_.verdict = s.certified ? GlobalVerdict::kAmbiguous : GlobalVerdict::kUncertified;
  return result_;
}

CloudRegistration Registrar::run() {
  CloudRegistration result = options_.judged ? decide() : propose();
  result.epsilon = epsilon_;
  result.matching_ms += clouds_.matching_ms();
  result.refinement_ms = clouds_.refinement_ms();
  return result;
}

CloudRegistration Registrar::decide() {
  for (int round = 0; round < options_.attempts; ++round) {
    if (round == 0 && source_.keypoints.size() > kManyKeypoints) {
      attempt(part(source_, 2), part(target_, 2));
    } else if (round < 2) {
      attempt(source_, target_);
    } else {
      attempt(redescribed(source_, 9, 800), redescribed(target_, 9, 800));
    }
    if (result_.verdict != GlobalVerdict::kCertain) continue;
    if (round == 0 && options_.attempts > 1 && result_.solution.consensus < kPreciseMatches) try_again();
    break;
  }
  return result_;
}

/// A certain pose with few matches may be imprecise: searches again with the matches of all keypoints. If
/// these lead to a different pose, the verdict becomes ambiguous.
void Registrar::try_again() {
  const CloudRegistration first = result_;
  attempt(source_, target_);
  if (result_.verdict != GlobalVerdict::kCertain) {
    const int attempts = result_.attempts;
    result_ = first;
    result_.attempts = attempts;
  } else if (clouds_.separation(first.target_from_source, result_.target_from_source) >= 1) {
    result_.verdict = GlobalVerdict::kAmbiguous;
    result_.why = "a search with more matches finds another pose: " + numbers();
  }
}

}  // namespace

const char* verdict_name(GlobalVerdict verdict) {
  switch (verdict) {
    case GlobalVerdict::kCertain:
      return "certain";
    case GlobalVerdict::kAmbiguous:
      return "ambiguous";
    case GlobalVerdict::kNoOverlap:
      return "no overlap";
    case GlobalVerdict::kUncertified:
      return "uncertified";
  }
  return "";
}

CloudRegistration register_clouds(const CloudDescription& source, const CloudDescription& target,
                                  const CloudRegistrationOptions& options, const CloudCheck* target_check) {
  if (source.voxel > 0 && target.voxel > 0 && source.voxel != target.voxel)
    throw std::invalid_argument("register_clouds: the descriptions have different voxels");
  if (source.keypoints.empty() || target.keypoints.empty()) {
    CloudRegistration nothing;
    nothing.solution.certified = true;
    nothing.why =
        std::string("the ") + (source.keypoints.empty() ? "source" : "target") + " has no keypoints";
    return nothing;
  }
  return Registrar(source, target, options, target_check).run();
}

}  // namespace scanlock
