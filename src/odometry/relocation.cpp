// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/relocation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "geometry/angles.hpp"
#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

constexpr double kFarGate = 2.0;      // metres: a prediction that may be so far off needs the far reach
constexpr double kAgreeMetres = 1.0;  // metres: results of two searches so near each other agree
constexpr double kAgreeRadians = 6.0 * kDegree;
// Of hypotheses within both of each other only one is tested.
constexpr double kTakenPlace = 0.3, kTakenHeading = 3.0 * kDegree;
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
  std::snprintf(text, sizeof text, "log odds of %.1f by %s, where %.1f are asked for: ", log_odds, by,
                kBelieved);
  return text;
}

}  // namespace

void Relocation::distrust(std::int64_t utime, double dt, const PreparedScan& scan, const Odometer& odometer,
                          double energy) {
  energy_before_ = energy;
  depart_or_follow(utime, dt, scan, odometer);
}

void Relocation::begin(const Odometer& odometer, const std::optional<Sighting>& last_seen, bool looks_alike,
                       const KeyframeArchive& archive) {
  lost_ = true;
  looks_alike_ = looks_alike;
  nothing_found_ = false;
  scans_ = 0;
  state_ = archive.empty() ? TrackingState::kLost : TrackingState::kRecovering;
  last_seen_ = last_seen;
  search_.begin(last_seen ? std::optional<Eigen::Vector3d>(odometer.state().pose.translation())
                          : std::nullopt);
}

void Relocation::end() {
  lost_ = false;
  excursion_.reset();
  candidate_.reset();
  elsewhere_ = false;
  search_.begin_anew();
}

Relocation::Outcome Relocation::follow(std::int64_t utime, double dt, const PreparedScan& scan,
                                       Odometer& odometer, Attempt* attempt) {
  ++scans_;
  depart_or_follow(utime, dt, scan, odometer);
  Outcome outcome = Outcome::kLost;
  if (candidate_) {
    outcome = confirm(scan, odometer, attempt);
  } else {
    feel(utime, scan, odometer, attempt);
  }
  if (outcome == Outcome::kLost) follow_excursion(dt, odometer);
  return outcome;
}

void Relocation::coast(double dt, Odometer& odometer) {
  excursion_->coast(dt);
  follow_excursion(dt, odometer);
}

/// Where lost-mode odometry begins anew the gate widens by the motion that may have gone unobserved.
void Relocation::depart_or_follow(std::int64_t utime, double dt, const PreparedScan& scan,
                                  const Odometer& odometer) {
  if (excursion_ && excursion_->follow(utime, dt, scan)) return;
  if (excursion_ && candidate_) refuse("the scans that followed do not fit each other: ");
  search_.begin_anew();
  finds_.clear();
  undecided_.clear();
  const Matrix12& covariance = odometer.covariance();
  gate_m_ = 0.5 + 3.0 * std::sqrt(covariance.diagonal().head<3>().maxCoeff());
  gate_rad_ = 3.0 * kDegree + 3.0 * std::sqrt(covariance.diagonal().segment<3>(3).maxCoeff());
  if (!excursion_) excursion_.emplace(config_, utime, scan, odometer.state());
}

/// The odometer's state becomes that of lost-mode odometry, which has measured the motion: the covariance of
/// the prediction does not grow.
void Relocation::follow_excursion(double dt, Odometer& odometer) const {
  MotionPrior prior = odometer.predict(0);
  prior.ahead_s = dt;
  prior.mean = excursion_->state();
  odometer.coast(prior);
}

/// Local relocalisation: aligns where the robot must be if it was only blinded, alternately at the prediction
/// and at the last trusted pose. An alignment that ends farther off is left to the certified search. Where
/// the place may be another that looks like the expected one, it is accepted only if the search, too, finds
/// nothing likelier.
void Relocation::feel(std::int64_t utime, const PreparedScan& scan, Odometer& odometer, Attempt* attempt) {
  const bool better_ask = looks_alike_ && (!nothing_found_ || state_ == TrackingState::kAmbiguous);
  if (!last_seen_ || odometer.empty() || better_ask) return;
  const bool standing = scans_ % 2 == 0;
  const MovingPose& predicted = excursion_->state();
  MotionPrior prior;
  prior.mean = predicted;
  if (standing) prior.mean.pose = last_seen_->map_from_body;
  prior.information = prior_information(gate_m_, gate_rad_, excursion_->covariance());
  *attempt = odometer.probe(scan, prior, gate_m_ < kFarGate ? Reach::kNear : Reach::kFar, Sides::kBoth);
  const Pose& found = attempt->alignment.moving.pose;
  const bool there = standing ? near(found, last_seen_->map_from_body, 0.5, 5.0 * kDegree)
                              : near(found, predicted.pose, gate_m_, gate_rad_);
  // On new ground a scan distorted by a wrong velocity may fit better; the gap from the measured one excludes
  // it.
  if (!there || !explains(*attempt, kJumpScore) || squared_gap(prior, attempt->alignment.moving) > kMostGap)
    return;
  looks_alike_ =
      looks_alike_ || contradiction(*last_seen_, utime, scan, attempt->alignment.moving) > kMostContradiction;
  if (!looks_alike_ || nothing_found_)
    candidate_ =
        Candidate{Contest::expected_at(renormalised(found * predicted.pose.inverse()), 1), std::nullopt};
}

/// Tests the hypotheses with this scan, and accepts one where the evidence is sufficient.
Relocation::Outcome Relocation::confirm(const PreparedScan& scan, Odometer& odometer, Attempt* attempt) {
  const Contest::Outcome outcome = candidate_->contest.judge(odometer, scan, *excursion_);
  *attempt = candidate_->contest.attempt();
  if (outcome == Contest::Outcome::kRefuted) refuse("the scans that followed do not fit: ");
  if (outcome == Contest::Outcome::kUndecided) {
    if (candidate_->answer) {
      if (log_odds_of(*candidate_) >= kBelieved) state_ = TrackingState::kAmbiguous;
      undecided_ = candidate_->contest.places();
    }
    refuse(std::string(candidate_->contest.why_undecided()) + ": ");
  }
  if (outcome != Contest::Outcome::kWon) return Outcome::kLost;
  const bool searched = candidate_->answer.has_value();
  if (searched) {
    const double log_odds = log_odds_of(*candidate_);
    if (log_odds < kBelieved) {  // the next search may add evidence
      if (candidate_->contest.is_spent())
        refuse(insufficient(log_odds, "all searches and the scans that followed"));
      return Outcome::kLost;
    }
    ended_ = recovery_of(*candidate_->answer);
    ended_->accepted = true;
    ended_->map_from_predicted = candidate_->contest.map_from_predicted();
    ended_->energy_after = attempt->health.energy;
  }
  elsewhere_ = candidate_->contest.is_elsewhere();
  candidate_.reset();
  return searched ? Outcome::kFound : Outcome::kFelt;
}

void Relocation::refuse(const std::string& why) {
  if (candidate_->answer) {
    ended_ = recovery_of(*candidate_->answer);
    ended_->reason.insert(0, why);
    ended_->energy_after = candidate_->contest.attempt().health.energy;
  }
  candidate_.reset();
}

Recovery Relocation::recovery_of(const RecoveryAnswer& answer) const {
  Recovery recovery;
  recovery.search = answer;
  recovery.map_from_predicted = answer.map_from_predicted;
  recovery.energy_before = energy_before_;
  recovery.reason = answer.reason;
  return recovery;
}

bool Relocation::gives_up() const {
  if (!lost_ || !excursion_ || candidate_ || excursion_->followed_s() < config_.new_map_after_s) return false;
  if (last_seen_) return true;
  const std::vector<ArchivedKeyframe>& seen = excursion_->seen().keyframes();
  return !seen.empty() &&
         (excursion_->state().pose.translation() - seen.front().map_from_body.translation()).norm() >
             kSameSpot * static_cast<double>(seen.front().reach);
}

std::optional<RecoveryRequest> Relocation::take_request(std::int64_t utime, const KeyframeArchive& archive,
                                                        const std::optional<Eigen::Vector3d>& up) {
  if (!lost_ || !excursion_ || (candidate_ && !(candidate_->answer && sees_more()))) return std::nullopt;
  std::optional<RecoveryRequest> request = search_.next(utime, excursion_->surroundings(), archive, up);
  if (request) request->undecided = undecided_;
  return request;
}

/// Whether another search can add evidence: for each number of keyframes one search on each scale can.
bool Relocation::sees_more() const {
  const std::size_t keyframes = excursion_->seen().keyframes().size();
  return std::count_if(finds_.begin(), finds_.end(),
                       [&](const Find& f) { return f.keyframes == keyframes; }) < kSearchScales;
}

void Relocation::give(RecoveryAnswer answer, const KeyframeArchive& archive, double voxel,
                      const Odometer& odometer) {
  const bool found = answer.verdict == PlaceVerdict::kFound;
  const bool gone = last_seen_ && answer.missing > kImpossible;
  if (gone) answer.log_odds = std::min(answer.log_odds, -before());
  const bool likely = answer.log_odds + before() > 0;
  if (!search_.take(answer.serial, likely, answer.little, answer.cost_s) || !lost_ || !excursion_) return;
  const bool planar = excursion_->planar();
  nothing_found_ = !found || (!planar && !likely);
  // A likely result, even if not proven to be the largest consensus, is tested beside later ones.
  const bool counts = (found && !(planar && answer.little)) || (!planar && likely);
  if (counts)
    finds_.insert(finds_.begin(), {answer.map_from_predicted, answer.log_odds,
                                   excursion_->seen().keyframes().size(), answer.voxel});
  if (finds_.size() > kMostFinds) finds_.pop_back();
  if (!found) {
    if (!candidate_ && state_ != TrackingState::kAmbiguous && search_.looked_everywhere())
      state_ = TrackingState::kLost;
    ended_ = recovery_of(answer);
    return;
  }
  if (state_ == TrackingState::kLost) state_ = TrackingState::kRecovering;
  const Support support = support_of(answer.map_from_predicted);
  double log_odds = before() + support.log_odds;
  // With the few points of a planar sensor log odds are unreliable: the number of agreeing results decides.
  if (planar) log_odds = (counts && support.finds > kPlanarAgreeing ? 1 : -1) * (kBelieved + kMostOfScans);
  if (log_odds + kMostOfScans < kBelieved) {
    ended_ = recovery_of(answer);
    ended_->reason.insert(0, planar ? "more searches have to agree: "
                             : gone ? "what is mapped there is gone: "
                                    : insufficient(log_odds, "all searches"));
    return;
  }
  if (candidate_ && candidate_->answer) {
    const std::vector<Pose> tried = candidate_->contest.places();
    if (std::any_of(tried.begin(), tried.end(), [&](const Pose& place) {
          return agree(place, answer.map_from_predicted, kAgreeMetres, kAgreeRadians);
        })) {
      ended_ = recovery_of(answer);
      ended_->reason.insert(0, "a place that is being tried: ");
      return;
    }
    undecided_ = tried;  // to be tested beside the new one
    refuse("a later search finds another place: ");
  }
  std::vector<Pose> places = rivals_of(answer);
  places.insert(places.begin(), answer.map_from_predicted);
  Contest contest(places, maps_of(places, archive, voxel, odometer));
  for (const Pose& standing : answer.standing) contest.note_standing(standing, *excursion_);
  candidate_ = Candidate{std::move(contest), std::move(answer), log_odds};
}

/// The evidence of the results that agree with this hypothesis. Of searches from the same keyframes on the
/// same scale only the newest counts: the earlier ones rest on the same data.
Relocation::Support Relocation::support_of(const Pose& map_from_predicted) const {
  Support support;
  std::vector<double> log_odds;
  std::vector<const Find*> counted;
  for (const Find& find : finds_) {
    if (!agree(find.map_from_predicted, map_from_predicted, kAgreeMetres, kAgreeRadians)) continue;
    ++support.finds;
    const auto says_the_same = [&](const Find* f) {
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
double Relocation::log_odds_of(const Candidate& candidate) const {
  if (excursion_->planar()) return candidate.log_odds;
  const Support support = support_of(candidate.contest.map_from_predicted());
  return (support.finds > 0 ? before() + support.log_odds : candidate.log_odds) +
         candidate.contest.log_odds();
}

/// An odometer in a map around each hypothesis, so that scans decide fairly between them; none where the
/// odometer's map shows all of them. Archived keyframes are thinner than the map at hand, and are not loaded
/// for a runner-up that they do not show better.
std::vector<std::unique_ptr<Odometer>> Relocation::maps_of(const std::vector<Pose>& places,
                                                           const KeyframeArchive& archive, double voxel,
                                                           const Odometer& odometer) const {
  std::vector<Eigen::Vector3d> centres;
  bool covered = true;
  for (const Pose& place : places) {
    const Eigen::Vector3d& centre = centres.emplace_back((place * excursion_->state().pose).translation());
    const double away = distance_to(odometer.map().keyframes(), centre);
    const bool rival = centres.size() > 1;
    covered = covered && (away < kCovered * archive.scene(centre) ||
                          (rival && away < kAsNear * distance_to(archive.keyframes(), centre)));
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

/// The hypotheses to test beside that of the answer: also earlier search results, and those that were
/// undecided before, because a few matches more or less do not decide between them.
std::vector<Pose> Relocation::rivals_of(const RecoveryAnswer& answer) const {
  std::vector<Pose> rivals;
  const auto add = [&](const Pose& place) {
    const auto is_place = [&](const Pose& other) { return agree(other, place, kTakenPlace, kTakenHeading); };
    const bool taken =
        is_place(answer.map_from_predicted) || std::any_of(rivals.begin(), rivals.end(), is_place);
    if (!taken && rivals.size() + 1 < kMostPlaces) rivals.push_back(place);
  };
  for (const Pose& place : undecided_) add(place);
  for (const Find& find : finds_)
    if (find.log_odds > 0) add(find.map_from_predicted);
  for (const Pose& place : answer.rivals) add(place);
  for (const Find& find : finds_) add(find.map_from_predicted);
  return rivals;
}

/// Whether two corrections put the robot at the same place.
bool Relocation::agree(const Pose& a, const Pose& b, double metres, double radians) const {
  const Pose& predicted = excursion_->state().pose;
  return near(a * predicted, b * predicted, metres, radians);
}

void Relocation::propose_here() {
  candidate_ = Candidate{Contest::expected_at(Pose::Identity(), 0), std::nullopt};
}

}  // namespace scanlock
