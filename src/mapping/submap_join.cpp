// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/submap_join.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "odometry/hypothesis_test.hpp"
#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

/// The covariance of the pose by a search with that voxel size.
Matrix6 resolution(const RecoveryRequest& search, double reach) {
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(search.target.voxel),
      Eigen::Vector3d::Constant(search.target.voxel / reach);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

JoinAnswer join_submaps(const JoinRequest& request, PlaceFinder& finder, const TrackerConfig& config) {
  JoinAnswer answer;
  answer.search = finder.find(request.search);
  answer.closure.serial = request.closure.serial;
  answer.closure.keyframe = request.closure.keyframe.id;
  answer.closure.reason = answer.search.reason;
  if (answer.search.verdict != PlaceVerdict::kFound || answer.search.contradiction > kSoundContradiction)
    return answer;

  ClosureRequest closure = request.closure;
  const Pose expected = renormalised(answer.search.map_from_predicted * closure.keyframe.map_from_body);
  const auto reach = static_cast<double>(closure.keyframe.reach);
  closure.earlier = nearest_to(expected.translation(), reach, request.search.target.places,
                               [](const ArchivedKeyframe&) { return true; });
  if (closure.earlier.empty()) return answer;
  const ArchivedKeyframe& nearest = closure.earlier.front();
  const std::optional<std::size_t> other = submap_of(nearest.id, request.others);
  if (!other) return answer;
  const Submap& submap = request.others[*other];
  const bool is_node = submap.graph.contains(nearest.id);
  answer.closure.nearest_keyframe = nearest.id;
  answer.closure.nearest = closure.nearest = is_node ? nearest.id : kOriginNode;
  closure.own_from_nearest = is_node ? nearest.map_from_body : submap.own_from_map;
  const std::optional<FoundClosure> closed =
      find_closure(closure, expected, resolution(request.search, reach), config, &answer.closure.reason);
  if (!closed) return answer;
  const Constraint& found = closed->constraint;
  // In a tunnel every pose along it fits, and agrees with every other.
  if (unknown_axes(inverse(found.information), kOnTheGround, kSamePlace, kSameHeading) != 0) {
    answer.closure.reason.insert(0, "does not constrain the pose: ");
    return answer;
  }
  answer.closure.closure = found;
  answer.closure.outcome = ClosureOutcome::kPending;

  const auto place = [&](std::uint32_t keyframe) -> Eigen::Vector3d {
    return request.active.graph.nodes().at(keyframe).translation();
  };
  std::vector<double> log_odds = {answer.search.log_odds};
  for (const JoinResult& find : request.finds) {
    const Constraint& earlier = find.closure;
    const bool there = submap.graph.contains(earlier.from) && request.active.graph.contains(earlier.to) &&
                       submap_of(find.nearest_keyframe, request.others) == other;
    if (!there || (place(earlier.to) - place(found.to)).norm() < kSameSpot * reach) continue;
    const RelativePose earlier_visit = submap.graph.relative({{earlier.from, found.from}}).front();
    const RelativePose this_visit = request.active.graph.relative({{earlier.to, found.to}}).front();
    if (!agree(earlier_visit, this_visit, earlier, found)) continue;
    answer.agreeing.push_back(earlier);
    log_odds.push_back(find.log_odds);
  }
  if (answer.agreeing.size() < kAgreeing) return answer;
  // A robot that was not found in the loaded map may be in another building: it gets no prior log odds. On a
  // meadow two finds that agree are little more evidence than one.
  const double before = request.active.located ? kInOwnMap : 0;
  // Another building of the same kind has rooms with the same walls but other furniture, which costs energy.
  const double against = std::clamp(log_odds_of_energy(closed->more_energy), -kMostOfScans, 0.0);
  if (before + against + together(std::move(log_odds)) < kBelieved) return answer;
  answer.closure.outcome = ClosureOutcome::kAccepted;
  PoseGraph graph = joined(request.active, submap, found);
  for (const Constraint& c : answer.agreeing) graph.connect(c);
  graph.connect(found);
  graph.optimise();
  answer.closure.map_from_node = graph.nodes();
  const std::vector<RelativePose> after = graph.relative({{found.from, found.to}, {kOriginNode, found.to}});
  answer.closure.revisits = {{found.to, found.from, answer.closure.nearest_keyframe, after[0].covariance}};
  answer.closure.drift = after[1].covariance;
  return answer;
}

void JoinSearch::begin() {
  search_results_.clear();
  search_.begin(std::nullopt);
  search_.begin_anew();
}

bool JoinSearch::is_due(std::uint32_t newest) {
  const bool is_new = asked_ != newest;
  asked_ = newest;
  return is_new && search_.is_due(scans_);
}

std::optional<RecoveryRequest> JoinSearch::next(std::int64_t utime, const LocalMap& map,
                                                const Pose& map_from_body, double scene,
                                                const KeyframeArchive& elsewhere) {
  return search_.next(utime, {map, map_from_body, scene, scans_, std::nullopt}, elsewhere, std::nullopt);
}

void JoinSearch::take(const JoinAnswer& answer) {
  const RecoveryAnswer& search = answer.search;
  search_.take(search.serial, answer.closure.outcome != ClosureOutcome::kRefused, search.little,
               search.cost_s);
}

void JoinSearch::remember(const JoinResult& find) {
  search_results_.insert(search_results_.begin(), find);
  search_results_.resize(std::min(search_results_.size(), kMostPlaces));
}

}  // namespace scanlock
