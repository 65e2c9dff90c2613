// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/relocalisation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "geometry/angles.hpp"
#include "global/hypothesis.hpp"
#include "odometry/kidnap_evidence.hpp"

namespace scanlock {
namespace {

constexpr double kFarGate = 2.0;  // metres: a prediction that may be so far off needs the far reach
constexpr double kCovered = 0.3;  // of the scene's size: a map with a keyframe so near shows the place
constexpr double kAsNear = 1.2;   // of the archive's least distance: a keyframe so near shows it as well

/// Metres from a place (map frame) to the nearest of the keyframes.
template <typename Keyframes>
double distance_to(const Keyframes& keyframes, const Eigen::Vector3d& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& k : keyframes) least = std::min(least, (k.map_from_body.translation() - place).norm());
  return least;
}

std::string insufficient(double log_odds, const char* by) {
  char text[120];
  std::snprintf(text, sizeof text, "log odds of %.1f by %s, below the required %.1f: ", log_odds, by,
                kBelieved);
  return text;
}

}  // namespace

void Relocalisation::distrust(std::int64_t utime, double dt, const PreparedScan& scan,
                              const Odometer& odometer, double energy) {
  energy_before_ = energy;
  depart_or_follow(utime, dt, scan, odometer);
}

void Relocalisation::begin(const Odometer& odometer, const std::optional<TrustedScan>& last_trusted,
                           bool looks_alike, const KeyframeArchive& archive) {
  lost_ = true;
  looks_alike_ = looks_alike;
  nothing_found_ = false;
  scans_ = 0;
  state_ = archive.empty() ? TrackingState::kLost : TrackingState::kRecovering;
  last_trusted_ = last_trusted;
  search_.begin(last_trusted ? std::optional<Eigen::Vector3d>(odometer.state().pose.translation())
                             : std::nullopt);
}

void Relocalisation::end() {
  lost_ = false;
  lost_odometry_.reset();
  last_scan_.reset();
  running_test_.reset();
  elsewhere_ = false;
  search_.begin_anew();
}

Relocalisation::Outcome Relocalisation::follow(std::int64_t utime, double dt, const PreparedScan& scan,
                                               Odometer& odometer, Attempt* attempt) {
  ++scans_;
  depart_or_follow(utime, dt, scan, odometer);
  Outcome outcome = Outcome::kLost;
  if (running_test_) {
    outcome = confirm(scan, odometer, attempt);
  } else {
    relocalise_locally(utime, scan, odometer, attempt);
  }
  if (outcome == Outcome::kLost) follow_lost_odometry(dt, odometer);
  return outcome;
}

void Relocalisation::coast(double dt, Odometer& odometer) {
  lost_odometry_->coast(dt);
  last_scan_.reset();
  follow_lost_odometry(dt, odometer);
}

/// Where lost-mode odometry begins anew the gate widens by the motion that may have gone unobserved.
void Relocalisation::depart_or_follow(std::int64_t utime, double dt, const PreparedScan& scan,
                                      const Odometer& odometer) {
  last_scan_ = scan;
  if (lost_odometry_ && lost_odometry_->follow(utime, dt, scan)) return;
  if (lost_odometry_ && running_test_) refuse("the scans after the search do not fit each other: ");
  search_.begin_anew();
  search_results_.clear();
  undecided_.clear();
  const Matrix12& covariance = odometer.covariance();
  gate_m_ = 0.5 + 3.0 * std::sqrt(covariance.diagonal().head<3>().maxCoeff());
  gate_rad_ = 3.0 * kDegree + 3.0 * std::sqrt(covariance.diagonal().segment<3>(3).maxCoeff());
  if (!lost_odometry_) lost_odometry_.emplace(config_, utime, scan, odometer.state());
}

/// The odometer's state becomes that of lost-mode odometry, which has measured the motion: the covariance of
/// the prediction does not grow.
void Relocalisation::follow_lost_odometry(double dt, Odometer& odometer) const {
  MotionPrior prior = odometer.predict(0);
  prior.ahead_s = dt;
  prior.mean = lost_odometry_->state();
  odometer.coast(prior);
}

/// Local relocalisation: aligns where the robot must be if it was only blinded, alternately at the prediction
/// and at the last trusted pose. An alignment that ends farther off is left to the certified search. Where
/// the place may be another that looks like the expected one, it is accepted only if the search, too, finds
/// nothing likelier.
void Relocalisation::relocalise_locally(std::int64_t utime, const PreparedScan& scan, Odometer& odometer,
                                        Attempt* attempt) {
  const bool better_ask = looks_alike_ && (!nothing_found_ || state_ == TrackingState::kAmbiguous);
  if (!last_trusted_ || odometer.empty() || better_ask) return;
  const bool unmoved = scans_ % 2 == 0;
  const MovingPose& predicted = lost_odometry_->state();
  MotionPrior prior;
  prior.mean = predicted;
  if (unmoved) prior.mean.pose = last_trusted_->map_from_body;
  prior.information = prior_information(gate_m_, gate_rad_, lost_odometry_->covariance());
  *attempt = odometer.probe(scan, prior, gate_m_ < kFarGate ? Reach::kNear : Reach::kFar, Sides::kBoth);
  const Pose& found = attempt->alignment.moving.pose;
  const bool there = unmoved ? near(found, last_trusted_->map_from_body, 0.5, 5.0 * kDegree)
                             : near(found, predicted.pose, gate_m_, gate_rad_);
  // On new ground a scan distorted by a wrong velocity may fit better; the gap from the measured one excludes
  // it.
  if (!there || !explains(*attempt, kJumpScore) || squared_gap(prior, attempt->alignment.moving) > kMostGap)
    return;
  if (!looks_alike_) {
    // At even odds, for the robot is lost. The motion from a prediction as wide as this one tells nothing.
    KidnapEvidence evidence;
    evidence.contradiction = contradiction(*last_trusted_, utime, scan, attempt->alignment.moving);
    evidence.inlier_ratio = inlier_ratio_to_usual(attempt->health);
    looks_alike_ = kidnap_log_odds(evidence) > 0;
  }
  if (!looks_alike_ || nothing_found_)
    running_test_ =
        RunningTest{HypothesisTest::expected_at(renormalised(found * predicted.pose.inverse()), 1), {}};
}

/// Tests the hypotheses with this scan, and accepts one where the evidence is sufficient.
Relocalisation::Outcome Relocalisation::confirm(const PreparedScan& scan, Odometer& odometer,
                                                Attempt* attempt) {
  const HypothesisTest::Outcome outcome = running_test_->test.judge(odometer, scan, *lost_odometry_);
  *attempt = running_test_->test.attempt();
  if (outcome == HypothesisTest::Outcome::kRefuted) refuse("the scans after the search fit no hypothesis: ");
  if (outcome == HypothesisTest::Outcome::kUndecided) {
    if (!running_test_->answers.empty()) {
      if (log_odds_of(*running_test_) >= kBelieved) state_ = TrackingState::kAmbiguous;
      undecided_ = running_test_->test.hypotheses();
    }
    refuse(std::string(running_test_->test.why_undecided()) + ": ");
  }
  if (outcome != HypothesisTest::Outcome::kWon) return Outcome::kLost;
  const bool searched = !running_test_->answers.empty();
  if (searched) {
    const double log_odds = log_odds_of(*running_test_);
    if (log_odds < kBelieved) {  // the next search may add evidence
      if (running_test_->test.is_spent())
        refuse(insufficient(log_odds, "all searches and the scans after them"));
      return Outcome::kLost;
    }
    ended_ = recovery_of(answer_for(*running_test_));
    ended_->accepted = true;
    ended_->map_from_predicted = running_test_->test.map_from_predicted();
    ended_->energy_after = attempt->health.energy;
  }
  elsewhere_ = running_test_->test.is_elsewhere();
  running_test_.reset();
  return searched ? Outcome::kFound : Outcome::kLocally;
}

void Relocalisation::refuse(const std::string& why) {
  if (!running_test_->answers.empty()) {
    ended_ = recovery_of(answer_for(*running_test_), why);
    ended_->energy_after = running_test_->test.attempt().health.energy;
  }
  running_test_.reset();
}

/// `why`: put before the reason of the search.
Recovery Relocalisation::recovery_of(const RecoveryAnswer& answer, const std::string& why) const {
  Recovery recovery;
  recovery.search = answer;
  recovery.map_from_predicted = answer.map_from_predicted;
  recovery.energy_before = energy_before_;
  recovery.reason = why + answer.reason;
  return recovery;
}

bool Relocalisation::gives_up() const {
  if (!lost_ || !lost_odometry_ || running_test_ || lost_odometry_->followed_s() < config_.new_map_after_s)
    return false;
  if (last_trusted_) return true;
  const std::vector<ArchivedKeyframe>& seen = lost_odometry_->seen().keyframes();
  return !seen.empty() &&
         (lost_odometry_->state().pose.translation() - seen.front().map_from_body.translation()).norm() >
             kSameSpot * static_cast<double>(seen.front().reach);
}

std::optional<RecoveryRequest> Relocalisation::take_request(std::int64_t utime,
                                                            const KeyframeArchive& archive,
                                                            const std::optional<Eigen::Vector3d>& up) {
  if (!lost_ || !lost_odometry_ || (running_test_ && (running_test_->answers.empty() || !sees_more())))
    return std::nullopt;
  std::optional<RecoveryRequest> request = search_.next(utime, lost_odometry_->surroundings(), archive, up);
  if (request) request->undecided = undecided_;
  return request;
}

/// Whether another search can add evidence: for each number of keyframes one search on each scale can.
bool Relocalisation::sees_more() const {
  const std::size_t keyframes = lost_odometry_->seen().keyframes().size();
  return std::count_if(search_results_.begin(), search_results_.end(),
                       [&](const SearchResult& f) { return f.keyframes == keyframes; }) < kSearchScales;
}

void Relocalisation::give(RecoveryAnswer answer, const KeyframeArchive& archive, double voxel,
                          Odometer& odometer) {
  const bool found = answer.verdict == PlaceVerdict::kFound;
  const bool gone = last_trusted_ && answer.missing > kImpossible;
  if (gone) answer.log_odds = std::min(answer.log_odds, -before());
  const bool likely = answer.log_odds + before() > 0;
  if (!search_.take(answer.serial, likely, answer.little, answer.cost_s) || !lost_ || !lost_odometry_) return;
  nothing_found_ = !found || !likely;
  // A likely result, even if not proven to be the largest consensus, is tested beside later ones.
  if (found || likely)
    search_results_.insert(search_results_.begin(),
                           {answer.map_from_predicted, answer.log_odds,
                            lost_odometry_->seen().keyframes().size(), answer.voxel});
  if (search_results_.size() > kMostResults) search_results_.pop_back();
  if (!found) {
    if (!running_test_ && state_ != TrackingState::kAmbiguous && search_.looked_everywhere())
      state_ = TrackingState::kLost;
    ended_ = recovery_of(answer);
    return;
  }
  if (state_ == TrackingState::kLost) state_ = TrackingState::kRecovering;
  const Support support = support_of(answer.map_from_predicted);
  const double log_odds = before() + support.log_odds;
  if (log_odds + kMostOfScans < kBelieved) {
    ended_ = recovery_of(
        answer, gone ? "surfaces of the map are missing there: " : insufficient(log_odds, "all searches"));
    return;
  }
  if (running_test_ && !running_test_->answers.empty()) {
    join_test(std::move(answer), archive, voxel, odometer);
    return;
  }
  std::vector<Pose> places = runners_up_of(answer);
  places.insert(places.begin(), answer.map_from_predicted);
  HypothesisTest test(places, maps_of(places, archive, voxel, odometer));
  for (const Pose& uncontradicted : answer.uncontradicted)
    test.note_uncontradicted(uncontradicted, *lost_odometry_);
  // The scan at hand is the first of the test; what it decides comes out with the next one.
  if (last_scan_) test.judge(odometer, *last_scan_, *lost_odometry_);
  running_test_ = RunningTest{std::move(test), {std::move(answer)}, log_odds};
}

/// A search has found a place while hypotheses are being tested: it is tested beside them.
void Relocalisation::join_test(RecoveryAnswer answer, const KeyframeArchive& archive, double voxel,
                               const Odometer& odometer) {
  const std::vector<Pose> tried = running_test_->test.hypotheses();
  const bool is_known = std::any_of(tried.begin(), tried.end(), [&](const Pose& place) {
    return agree(place, answer.map_from_predicted, kAgree);
  });
  ended_ = recovery_of(answer, is_known ? "this hypothesis is being tested already: "
                                        : "tested beside the hypotheses of earlier searches: ");
  if (answer.no_rival) {
    running_test_->test.keep_only(answer.map_from_predicted, lost_odometry_->state().pose);
    undecided_.clear();
  }
  if (is_known) return;
  auto maps = maps_of({answer.map_from_predicted}, archive, voxel, odometer);
  running_test_->test.add(answer.map_from_predicted, maps.empty() ? nullptr : std::move(maps.front()));
  running_test_->answers.push_back(std::move(answer));
}

/// The answer of the search that found the best hypothesis; of the first search for one that none found.
const RecoveryAnswer& Relocalisation::answer_for(const RunningTest& running) const {
  const auto found =
      std::find_if(running.answers.begin(), running.answers.end(), [&](const RecoveryAnswer& a) {
        return agree(a.map_from_predicted, running.test.map_from_predicted(), kAgree);
      });
  return found == running.answers.end() ? running.answers.front() : *found;
}

/// The evidence of the results that agree with this hypothesis. Of searches from the same keyframes on the
/// same scale only the newest counts: the earlier ones rest on the same data.
Relocalisation::Support Relocalisation::support_of(const Pose& map_from_predicted) const {
  Support support;
  std::vector<double> log_odds;
  std::vector<const SearchResult*> counted;
  for (const SearchResult& find : search_results_) {
    if (!agree(find.map_from_predicted, map_from_predicted, kAgree)) continue;
    ++support.finds;
    const auto says_the_same = [&](const SearchResult* f) {
      return f->keyframes == find.keyframes && f->voxel == find.voxel;
    };
    if (std::any_of(counted.begin(), counted.end(), says_the_same)) continue;
    counted.push_back(&find);
    log_odds.push_back(find.log_odds);
  }
  if (support.finds > 0) support.log_odds = together(std::move(log_odds));
  return support;
}

/// Log odds that the best hypothesis of the test is right, by all searches and by the last scan. A hypothesis
/// that no search found likeliest has the log odds of the search that named it.
double Relocalisation::log_odds_of(const RunningTest& candidate) const {
  const Support support = support_of(candidate.test.map_from_predicted());
  return (support.finds > 0 ? before() + support.log_odds : candidate.log_odds) + candidate.test.log_odds();
}

/// An odometer in a map around each hypothesis, so that scans decide fairly between them; none where the
/// odometer's map shows all of them, and those under test have no maps of their own either. Archived
/// keyframes are thinner than the map at hand, and are not loaded for a runner-up that they do not show
/// better.
std::vector<std::unique_ptr<Odometer>> Relocalisation::maps_of(const std::vector<Pose>& places,
                                                               const KeyframeArchive& archive, double voxel,
                                                               const Odometer& odometer) const {
  std::vector<Eigen::Vector3d> centres;
  bool covered = !(running_test_ && running_test_->test.is_elsewhere());
  for (const Pose& place : places) {
    const Eigen::Vector3d& centre =
        centres.emplace_back((place * lost_odometry_->state().pose).translation());
    const double away = distance_to(odometer.map().keyframes(), centre);
    const bool runner_up = centres.size() > 1;
    covered = covered && (away < kCovered * archive.scene(centre) ||
                          (runner_up && away < kAsNear * distance_to(archive.keyframes(), centre)));
  }
  std::vector<std::unique_ptr<Odometer>> maps;
  if (covered) return maps;
  for (const Eigen::Vector3d& centre : centres) {
    maps.push_back(std::make_unique<Odometer>(config_));
    maps.back()->set_planar(odometer.planar());
    maps.back()->reload(archive.keyframes(), centre, voxel, archive.fixed());
  }
  return maps;
}

/// The hypotheses to test beside that of the answer, unless it excludes all of them: also earlier search
/// results, and those that were undecided before, because a few matches more or less do not decide between
/// them.
std::vector<Pose> Relocalisation::runners_up_of(const RecoveryAnswer& answer) const {
  std::vector<Pose> runners_up;
  if (answer.no_rival) return runners_up;
  const auto add = [&](const Pose& place) {
    const auto is_place = [&](const Pose& other) { return agree(other, place, 1); };
    const bool taken =
        is_place(answer.map_from_predicted) || std::any_of(runners_up.begin(), runners_up.end(), is_place);
    if (!taken && runners_up.size() + 1 < kMostPlaces) runners_up.push_back(place);
  };
  for (const Pose& place : undecided_) add(place);
  for (const SearchResult& find : search_results_)
    if (find.log_odds > 0) add(find.map_from_predicted);
  for (const Pose& place : answer.runners_up) add(place);
  for (const SearchResult& find : search_results_) add(find.map_from_predicted);
  return runners_up;
}

/// Whether two corrections put the robot at the same place.
bool Relocalisation::agree(const Pose& a, const Pose& b, double times) const {
  return same_place(a, b, lost_odometry_->state().pose, times);
}

void Relocalisation::propose_here() {
  running_test_ = RunningTest{HypothesisTest::expected_at(Pose::Identity(), 0), {}};
}

}  // namespace scanlock
