// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/hypothesis_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"
#include "geometry/linear.hpp"
#include "geometry/voxel_grid.hpp"
#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

// Least inlier ratio of a scan that fits a hypothesis, over the running median: rooms that look alike have
// 0.85 to 0.93. The second one is for a hypothesis that a search supports or nothing contradicts: the other
// points may be on ground that the map does not cover.
constexpr double kUsualShare = 0.9, kKnownShare = 0.3;
constexpr double kUnknownShare = 0.5;  // assumed running median before an alignment was accepted
constexpr int kWins = 3;               // scans in a row
constexpr int kMissesAllowed = 1;      // scans that do not fit a hypothesis
constexpr double kFew = 0.25;          // pseudocount, in mean numbers of points in a patch
// Standard deviations that a difference of counts exceeds by chance once in 30,000 scans. In a hall with two
// ends alike, at 250 points per scan, the differences scattered by 0.9 to 1.0 of these, and by at most 3.2 in
// 141 scans.
constexpr double kChance = 4;
// Energy of a scan less its running median, at which its log odds are 0, and log odds per unit of energy. Of
// 1052 scans of a vlp16 at the right place in a map of another drive half had more than 0.02 and 5 of 100
// more than 0.048; of 990 scans in maps of other buildings all had more than 0.089 and half more than 0.21.
// In a town, scans at the right place have up to 0.13, and the log odds of searches are high there.
constexpr double kMoreEnergy = 0.07, kOddsOfEnergy = 200;
// Upper bound of the log odds by energy: one per kPatchesAFold patches of steep surfaces, but at least
// kLeastOfFit. One to eight scans of rooms met 40 to 330 such patches.
constexpr double kLeastOfFit = 2.5, kPatchesAFold = 15;
// The drift of lost-mode odometry since the search may exceed the near reach of an alignment. Hypotheses that
// have never fitted are therefore also aligned with the far reach: at most this many per scan, because that
// takes time, and all of them within kWins scans.
constexpr int kFarLooks = 2;
constexpr int kMostScans = 8;  // scans that fit the best hypothesis, within which the test has to decide

/// Whether the scan leaves the pose unobservable along a horizontal axis or in yaw, as along a tunnel. A
/// prior of the size of one place bounds all directions, so that an unobservable height does not make the
/// horizontal axes uncertain.
bool is_open(const Attempt& attempt) {
  Vector6 about;
  about << Eigen::Vector3d::Constant(kSamePlace), Eigen::Vector3d::Constant(kSameHeading);
  const Matrix6 before = about.cwiseAbs2().cwiseInverse().asDiagonal();
  return unknown_axes(inverse(Matrix6(attempt.information() + before)), kOnTheGround, kSamePlace,
                      kSameHeading) != 0;
}

}  // namespace

double log_odds_of_energy(double more) {
  return kOddsOfEnergy * (kMoreEnergy - more);
}

HypothesisTest::HypothesisTest(const std::vector<Pose>& map_from_predicted,
                               std::vector<std::unique_ptr<Odometer>> maps) {
  maps.resize(map_from_predicted.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    add(map_from_predicted[i], std::move(maps[i]));
    if (i > 0) hypotheses_.back().least_share = kUsualShare;
  }
}

void HypothesisTest::add(const Pose& map_from_predicted, std::unique_ptr<Odometer> map) {
  if (hypotheses_.size() >= kMostPlaces) hypotheses_.pop_back();
  Hypothesis hypothesis;
  hypothesis.map_from_predicted = map_from_predicted;
  hypothesis.map = std::move(map);
  hypothesis.least_share = kKnownShare;
  hypotheses_.push_back(std::move(hypothesis));
  scans_ = 0;
}

void HypothesisTest::keep_only(const Pose& map_from_predicted, const Pose& predicted) {
  const auto is_it = [&](const Hypothesis& hypothesis) {
    return same_place(hypothesis.map_from_predicted, map_from_predicted, predicted, kAgree);
  };
  const auto it = std::find_if(hypotheses_.begin(), hypotheses_.end(), is_it);
  if (it == hypotheses_.end()) return;
  std::iter_swap(hypotheses_.begin(), it);
  hypotheses_.erase(hypotheses_.begin() + 1, hypotheses_.end());
}

HypothesisTest HypothesisTest::expected_at(const Pose& map_from_predicted, int wins) {
  HypothesisTest test({map_from_predicted});
  Hypothesis& hypothesis = test.hypotheses_.front();
  hypothesis.least_share = kUsualShare;
  hypothesis.tried = wins > 0;
  test.wins_ = wins;
  test.expected_ = true;
  return test;
}

void HypothesisTest::note_uncontradicted(const Pose& map_from_predicted,
                                         const LostModeOdometry& lost_odometry) {
  const Pose& predicted = lost_odometry.state().pose;
  for (auto runner_up = hypotheses_.begin() + 1; runner_up != hypotheses_.end(); ++runner_up) {
    if (!same_place(runner_up->map_from_predicted, map_from_predicted, predicted)) continue;
    runner_up->least_share = kKnownShare;
  }
}

double HypothesisTest::Hypothesis::explained() const {
  return std::accumulate(patches.begin(), patches.end(), 0.0,
                         [](double sum, const Patch& patch) { return sum + patch.explained; });
}

/// Whether `place` is clearly worse than `other`, by the points that meet a surface and do not lie on it. The
/// number of such points in a patch has a long tail, at the right place (people, moved objects) and at
/// others, so that its logarithm counts. Regions that a map does not cover carry no evidence: a patch counts
/// by the share of its points that meet a surface in both maps. Of 3,913 pairs of the right place and another
/// one that fits (57 starts in maps of rooms) none has a difference below 1.8, and its factor in a logistic
/// regression is 1.0 (these figures, and the deviations at kChance, are of distances that were not scaled by
/// the thickness of a surface). The difference also has to exceed kChance standard deviations of the counts,
/// because between few points it may be chance.
bool HypothesisTest::is_worse(const Hypothesis& hypothesis, const Hypothesis& other) const {
  const double few =
      kFew * std::accumulate(points_.begin(), points_.end(), 0.0) / static_cast<double>(points_.size());
  double log_odds = 0, variance = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Hypothesis::Patch &here = hypothesis.patches[i], &there = other.patches[i];
    const double both = std::min(here.known, there.known) / points_[i];
    const double mean = few + 0.5 * (here.off() + there.off());
    log_odds += both * (log1p(here.off() / few) - log1p(there.off() / few));
    variance += both * both * (here.off() + there.off()) / (mean * mean);
  }
  return log_odds > std::max(kBelieved, kChance * std::sqrt(variance));
}

double HypothesisTest::log_odds() const {
  const Hypothesis& leader = hypotheses_.front();
  const Health& health = leader.attempt.health;
  if (health.baseline <= 0) return 0;
  double stand_up = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) stand_up += leader.patches[i].steep / points_[i];
  const double most = std::clamp(stand_up / kPatchesAFold, kLeastOfFit, kMostOfScans);
  return std::clamp(log_odds_of_energy(health.energy - health.baseline), -kMostOfScans, most);
}

/// Adds the points of the scan at its predicted pose to the counts of the patches. `anew`: the earlier counts
/// are discarded, because a hypothesis that fits for the first time was not aligned well enough before.
void HypothesisTest::note_explained(const PreparedScan& scan, const Pose& predicted, bool anew) {
  if (anew) {
    patches_.clear();
    points_.clear();
    for (Hypothesis& hypothesis : hypotheses_) hypothesis.patches.clear();
    patch_ = Odometer::patch(scan);
  }
  for (std::size_t i = 0; i < scan.source.size(); ++i) {
    const Eigen::Array3i cell =
        (predicted * scan.source.point(i).cast<double>() / patch_).array().floor().cast<int>();
    const std::size_t k =
        patches_.emplace(morton_key(cell.x(), cell.y(), cell.z()), patches_.size()).first->second;
    points_.resize(patches_.size());
    ++points_[k];
    for (Hypothesis& hypothesis : hypotheses_) {
      hypothesis.patches.resize(patches_.size());
      // A probe that ended with a part of the scan has no matches of its single points.
      const bool whole = hypothesis.point_matches.size() == scan.source.size();
      const PointMatch match = whole ? hypothesis.point_matches[i] : PointMatch{};
      Hypothesis::Patch& patch = hypothesis.patches[k];
      patch.known += match.known ? 1 : 0;
      patch.explained += match.explained ? 1 : 0;
      patch.steep += match.steep ? 1 : 0;
    }
  }
}

/// `most`: the largest inlier ratio of all hypotheses. Points on surfaces that a coarse map lacks at all of
/// them are no evidence against any.
bool HypothesisTest::fits(const Attempt& attempt, const Hypothesis& hypothesis, double most) const {
  const double usual =
      attempt.health.median_inlier_ratio > 0 ? attempt.health.median_inlier_ratio : kUnknownShare;
  const double needed = std::max(hypothesis.least_share * std::min(usual, most), kKnownShare * usual);
  // A map of another sensor or day explains scans less well than recent ones were explained: the z-score is
  // no evidence against the result of a search.
  return explains(attempt, expected_ ? kJumpScore : std::numeric_limits<double>::infinity()) &&
         attempt.health.inlier_ratio >= needed &&
         near(attempt.alignment.moving.pose, attempt.prior.mean.pose, 3.0 * hypothesis.near_metres(),
              3.0 * hypothesis.near_radians());
}

void HypothesisTest::look_near(Odometer& odometer, const PreparedScan& scan,
                               const LostModeOdometry& lost_odometry, Hypothesis& hypothesis) const {
  const MovingPose& predicted = lost_odometry.state();
  MotionPrior prior;
  prior.mean = {renormalised(hypothesis.map_from_predicted * predicted.pose), predicted.twist};
  prior.information =
      prior_information(hypothesis.near_metres(), hypothesis.near_radians(), lost_odometry.covariance());
  hypothesis.attempt = odometer.align(scan, prior, Reach::kNear, Sides::kBoth);
  hypothesis.point_matches = odometer.point_matches();
}

void HypothesisTest::try_hypothesis(Odometer& odometer, const PreparedScan& scan,
                                    const LostModeOdometry& lost_odometry, double most, int* far_looks,
                                    Hypothesis& hypothesis) const {
  if (hypothesis.is_due() && !fits(hypothesis.attempt, hypothesis, most) && *far_looks > 0) {
    --*far_looks;
    hypothesis.looked_far = true;
    Attempt far = odometer.probe(scan, hypothesis.attempt.prior, Reach::kFar, Sides::kBoth);
    if (far.cost() < hypothesis.attempt.cost()) {
      hypothesis.attempt = std::move(far);
      hypothesis.point_matches = odometer.point_matches();
    }
  }
  hypothesis.fits = fits(hypothesis.attempt, hypothesis, most);
  if (hypothesis.fits) {
    hypothesis.map_from_predicted =
        renormalised(hypothesis.attempt.alignment.moving.pose * lost_odometry.state().pose.inverse());
    hypothesis.tried = true;
  } else if (!hypothesis.is_due()) {
    ++hypothesis.missed;
  }
}

HypothesisTest::Outcome HypothesisTest::judge(Odometer& odometer, const PreparedScan& scan,
                                              const LostModeOdometry& lost_odometry) {
  const Pose led_by = hypotheses_.front().map_from_predicted;
  const bool led = wins_ > 0;
  odometer.take_usual_from(lost_odometry.odometer());
  int far_looks = kFarLooks;
  bool anew = patches_.empty();
  const auto map_of = [&](Hypothesis& hypothesis) -> Odometer& {
    return hypothesis.map ? *hypothesis.map : odometer;
  };
  double most = expected_ ? 1 : 0;
  for (Hypothesis& hypothesis : hypotheses_) {
    if (hypothesis.map) hypothesis.map->take_usual_from(odometer);
    look_near(map_of(hypothesis), scan, lost_odometry, hypothesis);
    most = std::max(most, hypothesis.attempt.health.inlier_ratio);
  }
  for (Hypothesis& hypothesis : hypotheses_) {
    const bool tried = hypothesis.tried;
    try_hypothesis(map_of(hypothesis), scan, lost_odometry, most, &far_looks, hypothesis);
    anew = anew || (hypothesis.tried && !tried);
  }
  note_explained(scan, lost_odometry.state().pose, anew);
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.fits != b.fits ? a.fits : a.explained() > b.explained();
  });
  drop_losers(lost_odometry.state().pose);
  const Hypothesis& leader = hypotheses_.front();
  if (!leader.fits) {
    wins_ = 0;
    return leader.missed > kMissesAllowed ? Outcome::kRefuted : Outcome::kOpen;
  }
  // Hypotheses that are clearly worse were dropped above.
  const bool clear =
      std::none_of(hypotheses_.begin() + 1, hypotheses_.end(), [](const Hypothesis& p) { return p.fits; });
  if (clear && !expected_ && is_open(leader.attempt)) return Outcome::kUndecided;
  const bool same = !led || same_place(led_by, leader.map_from_predicted, lost_odometry.state().pose, kAgree);
  wins_ = !clear ? 0 : same ? wins_ + 1 : 1;
  ++scans_;
  if (wins_ >= kWins) return Outcome::kWon;
  return is_spent() ? Outcome::kUndecided : Outcome::kOpen;
}

bool HypothesisTest::is_spent() const {
  return scans_ >= kMostScans;
}

const char* HypothesisTest::why_undecided() const {
  return hypotheses_.size() > 1 ? "the scans after the search fit several hypotheses equally well"
                                : "the scans after the search do not constrain the pose";
}

std::vector<Pose> HypothesisTest::hypotheses() const {
  std::vector<Pose> result;
  for (const Hypothesis& hypothesis : hypotheses_) result.push_back(hypothesis.map_from_predicted);
  return result;
}

/// Drops hypotheses that more than kMissesAllowed scans did not fit (unless they are the best), that are
/// clearly worse than one that fits, or that have moved to the pose of a better one.
void HypothesisTest::drop_losers(const Pose& predicted) {
  std::vector<Hypothesis> left;
  const auto beats = [&](const Hypothesis& winner, const Hypothesis& loser) {
    return winner.fits && !loser.is_due() && is_worse(loser, winner);
  };
  for (Hypothesis& hypothesis : hypotheses_) {
    const bool missing = !left.empty() && !hypothesis.is_due() && hypothesis.missed > kMissesAllowed;
    const bool out = missing || std::any_of(left.begin(), left.end(), [&](const Hypothesis& other) {
                       return beats(other, hypothesis) ||
                              same_place(other.map_from_predicted, hypothesis.map_from_predicted, predicted);
                     });
    if (out) continue;
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](const Hypothesis& other) { return beats(hypothesis, other); }),
               left.end());
    left.push_back(std::move(hypothesis));
  }
  hypotheses_ = std::move(left);
}

}  // namespace scanlock
