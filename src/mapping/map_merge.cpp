// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/map_merge.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/loop_closure.hpp"
#include "mapping/submap.hpp"
#include "mapping/submap_join.hpp"
#include "odometry/place_search.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {
namespace {

// Caps on cost: a search takes about a second of CPU.
constexpr std::size_t kMostKeyframes = 100;  // of the second map that are searched for
constexpr int kLooks = 3;  // searches of one keyframe, each in another part of the first map
// Keyframes that are sampled for the usual energy and inlier ratio of the second map.
constexpr std::size_t kLearnt = 50;

/// The keyframes of a map that constraints connect to its frame, with ids from `first_id` on, and their
/// graph.
struct Side {
  std::vector<ArchivedKeyframe> keyframes;
  Submap submap;

  Side(const SavedMap& saved, std::uint32_t first_id) {
    const PoseGraph whole = submaps_of(saved).front().graph;
    std::map<std::uint32_t, std::uint32_t> ids = {{kOriginNode, kOriginNode}};
    submap.graph.add(kOriginNode, Pose::Identity());
    for (std::uint32_t place = 1; place <= saved.keyframes.size(); ++place) {
      if (!whole.contains(place)) continue;
      ArchivedKeyframe keyframe = saved.keyframes[place - 1];
      keyframe.id = first_id++;
      ids.emplace(place, keyframe.id);
      submap.graph.add(keyframe.id, keyframe.map_from_body);
      keyframes.push_back(std::move(keyframe));
    }
    for (Constraint c : whole.constraints()) {
      c.from = ids.at(c.from);
      c.to = ids.at(c.to);
      submap.graph.connect(c);
    }
  }

  const ArchivedKeyframe& keyframe(std::uint32_t id) const { return keyframes[id - keyframes.front().id]; }
};

class Merger {
 public:
  Merger(const SavedMap& first, const SavedMap& second, const TrackerConfig& config,
         const std::function<void(std::uint64_t, std::uint64_t)>& progress)
      : config_(config),
        progress_(progress),
        there_(first, 1),
        here_(second, static_cast<std::uint32_t>(there_.keyframes.size()) + 1),
        archive_(std::numeric_limits<std::size_t>::max()) {
    archive_.restore(there_.keyframes, true);
    planar_ = !here_.keyframes.empty() && is_planar(*here_.keyframes.front().points.cloud());
    learn();
  }

  /// Joins the graphs. False where too few searches agree on the relative pose, or two other ones agree on
  /// another.
  bool join(MapMerge* result) {
    const std::vector<std::uint32_t> wanted = spread();
    all_ = wanted.size() + here_.keyframes.size();
    std::vector<JoinResult> finds;
    for (const std::uint32_t id : wanted) {
      tell();
      const std::vector<JoinAnswer> answers = look_for(here_.keyframe(id), {});
      result->found += answers.empty() ? 0 : 1;
      for (const JoinAnswer& answer : answers)
        finds.push_back({answer.closure.closure, answer.closure.nearest_keyframe, answer.search.log_odds});
    }
    result->searches = wanted.size();
    const auto [agreeing, others] = largest_agreement(finds);
    result->agreeing = agreeing.size();
    result->otherwise = largest_agreement(others).first.size();
    if (agreeing.size() < kAgreeingSearches || result->otherwise > 1) return false;
    // Repeats the search with which all of them agree, now with their finds, so that it can be accepted.
    const std::vector<JoinAnswer> answers =
        look_for(here_.keyframe(agreeing.front().closure.to), {agreeing.begin() + 1, agreeing.end()});
    const auto answer = std::find_if(answers.begin(), answers.end(), [](const JoinAnswer& a) {
      return a.closure.outcome == ClosureOutcome::kAccepted;
    });
    if (answer == answers.end()) return false;
    both_ = joined(here_.submap, there_.submap, answer->closure.closure);
    for (const Constraint& c : answer->agreeing) both_.connect(c);
    settle(answer->closure);
    return true;
  }

  /// Searches for loop closures along the overlap, in the order of the second map's keyframes.
  void close_loops() {
    std::optional<Constraint> pending;
    for (std::size_t i = 0; i < here_.keyframes.size(); ++i) {
      tell();
      ClosureRequest request = around(here_.keyframes[i]);
      request.earlier = nearest_to(request.keyframe.map_from_body.translation(),
                                   static_cast<double>(request.keyframe.reach), there_.keyframes,
                                   [](const ArchivedKeyframe&) { return true; });
      if (request.earlier.empty() || request.recent.empty()) continue;
      request.graph = both_;
      request.nearest = request.nearest_keyframe = request.earlier.front().id;
      request.own_from_nearest = request.earlier.front().map_from_body;
      request.pending = std::exchange(pending, std::nullopt);
      request.usual_information = usual_information_;
      const ClosureAnswer answer = close_loop(request, config_);
      if (answer.outcome == ClosureOutcome::kPending) pending = answer.closure;
      if (answer.outcome != ClosureOutcome::kAccepted) continue;
      both_.connect(*request.pending);
      settle(answer);
    }
  }

  /// The content of the map file.
  SavedMap saved(const SavedMap& first) const {
    SavedMap map;
    map.epoch = first.epoch;
    map.last_pose = first.last_pose;
    map.up = first.up;
    for (const Side* side : {&there_, &here_})
      map.keyframes.insert(map.keyframes.end(), side->keyframes.begin(), side->keyframes.end());
    map.constraints = both_.constraints();
    return map;
  }

  std::size_t closures() const {
    const auto is_second = [&](std::uint32_t id) { return id >= here_.keyframes.front().id; };
    return static_cast<std::size_t>(
        std::count_if(both_.constraints().begin(), both_.constraints().end(),
                      [&](const Constraint& c) { return is_second(c.from) != is_second(c.to); }));
  }

 private:
  void tell() {
    if (progress_) progress_(done_++, all_);
  }

  /// Learns the energy and inlier ratio of alignments within the second map, which alignments with the first
  /// map are compared with.
  void learn() {
    Odometer odometer(config_);
    odometer.set_planar(planar_);
    const std::size_t step = std::max<std::size_t>(1, here_.keyframes.size() / kLearnt);
    for (std::size_t i = 0; i < here_.keyframes.size(); i += step) {
      const ClosureRequest request = around(here_.keyframes[i]);
      if (!request.recent.empty()) learn_usual(request, &odometer);
    }
    usual_ = odometer.usual();
  }

  /// Ids of keyframes of the second map that are a third of a reach apart, so that their finds count as
  /// independent.
  std::vector<std::uint32_t> spread() const {
    std::vector<std::uint32_t> apart;
    for (const ArchivedKeyframe& k : here_.keyframes) {
      const bool is_covered = std::any_of(apart.begin(), apart.end(), [&](std::uint32_t id) {
        const Eigen::Vector3d way =
            here_.keyframe(id).map_from_body.translation() - k.map_from_body.translation();
        return way.norm() < kSameSpot * static_cast<double>(k.reach);
      });
      if (!is_covered) apart.push_back(k.id);
    }
    const std::size_t step = (apart.size() + kMostKeyframes - 1) / kMostKeyframes;
    std::vector<std::uint32_t> taken;
    for (std::size_t i = 0; i < apart.size(); i += step) taken.push_back(apart[i]);
    return taken;
  }

  /// The largest set of finds that agree with one of them, which comes first; and all finds that do not agree
  /// with that one. Of a keyframe with several agreeing finds one is counted.
  std::pair<std::vector<JoinResult>, std::vector<JoinResult>> largest_agreement(
      const std::vector<JoinResult>& finds) const {
    std::vector<JoinResult> most, rest;
    for (const JoinResult& find : finds) {
      std::vector<JoinResult> agreeing = {find}, others;
      std::vector<PoseGraph::Pair> pairs_there, pairs_here;
      for (const JoinResult& other : finds) {
        pairs_there.emplace_back(other.closure.from, find.closure.from);
        pairs_here.emplace_back(other.closure.to, find.closure.to);
      }
      const std::vector<RelativePose> there = there_.submap.graph.relative(pairs_there),
                                      here = here_.submap.graph.relative(pairs_here);
      for (std::size_t i = 0; i < finds.size(); ++i) {
        const JoinResult& other = finds[i];
        if (&other == &find) continue;
        const bool agrees = agree(there[i], here[i], other.closure, find.closure);
        const bool counted = std::any_of(agreeing.begin(), agreeing.end(), [&](const JoinResult& f) {
          return f.closure.to == other.closure.to;
        });
        if (!agrees) others.push_back(other);
        if (agrees && !counted) agreeing.push_back(other);
      }
      if (agreeing.size() <= most.size()) continue;
      most = std::move(agreeing);
      rest = std::move(others);
    }
    return {most, rest};
  }

  ClosureRequest around(const ArchivedKeyframe& keyframe) const {
    ClosureRequest request;
    request.keyframe = keyframe;
    request.recent =
        nearest_to(keyframe.map_from_body.translation(), static_cast<double>(keyframe.reach), here_.keyframes,
                   [&](const ArchivedKeyframe& k) { return k.id != keyframe.id; });
    request.voxel = std::clamp(kKeyframeVoxel * static_cast<double>(keyframe.reach), config_.min_voxel_m,
                               config_.max_voxel_m);
    request.planar = planar_;
    request.usual = usual_;
    return request;
  }

  /// Searches for a keyframe's surroundings in the parts of the first map that look most like them; the
  /// accepted and pending answers.
  std::vector<JoinAnswer> look_for(const ArchivedKeyframe& keyframe, const std::vector<JoinResult>& finds) {
    std::vector<JoinAnswer> found;
    JoinRequest request;
    request.closure = around(keyframe);
    if (request.closure.recent.empty()) return found;
    request.active = here_.submap;
    request.others = {there_.submap};
    request.finds = finds;
    Odometer seen(config_);
    seen.set_planar(planar_);
    std::vector<ArchivedKeyframe> near = request.closure.recent;
    near.push_back(keyframe);
    seen.reload(near, keyframe.map_from_body.translation(), request.closure.voxel);
    PlaceSearch search(kUnlimited, PlaceSearch::Parts::kNarrow);
    search.begin(std::nullopt);
    search.begin_anew();
    for (int look = 1; look <= kLooks && !search.looked_everywhere(); ++look) {
      const Surroundings surroundings{seen.map(), keyframe.map_from_body, static_cast<double>(keyframe.reach),
                                      look * kPause, std::nullopt};
      std::optional<RecoveryRequest> next = search.next(1, surroundings, archive_, std::nullopt);
      if (!next) break;
      request.search = std::move(*next);
      const JoinAnswer answer = join_submaps(request, finder_, config_);
      if (answer.closure.outcome != ClosureOutcome::kRefused) found.push_back(answer);
      // The other parts are searched whatever was found here, for they may look the same.
      search.take(answer.search.serial, false, answer.search.little, 0);
    }
    return found;
  }

  /// Takes an accepted closure and the poses of the graph that was optimised with it.
  void settle(const ClosureAnswer& answer) {
    both_.connect(answer.closure);
    both_.move(answer.map_from_node);
    usual_information_ = answer.closure.information;
    for (Side* side : {&there_, &here_}) {
      for (ArchivedKeyframe& k : side->keyframes) {
        const Pose& moved = both_.nodes().at(k.id);
        const Eigen::Matrix3d turn = moved.linear() * k.map_from_body.linear().transpose();
        for (Eigen::Vector3f& stand : k.body_ups) stand = turn.cast<float>() * stand;
        k.map_from_body = moved;
      }
    }
  }

  static constexpr double kUnlimited = 1e9;  // cores: the whole CPU may be used
  static constexpr int kPause = 10000;       // scans: more than any pause between two searches
  TrackerConfig config_;
  const std::function<void(std::uint64_t, std::uint64_t)>& progress_;
  std::uint64_t done_ = 0, all_ = 0;  ///< keyframes
  Side there_, here_;                 ///< the first and the second map; in one frame once they are joined
  KeyframeArchive archive_;           ///< keyframes of the first map
  bool planar_ = false;
  Odometer::Usual usual_;
  PlaceFinder finder_;
  PoseGraph both_;  ///< the joined graph
  Matrix6 usual_information_ = Matrix6::Identity();
};

}  // namespace

MapMerge merge_maps(const SavedMap& first, const SavedMap& second, const TrackerConfig& config,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  MapMerge result;
  if (first.keyframes.empty() || second.keyframes.empty()) return result;
  Merger merger(first, second, config, progress);
  result.joined = merger.join(&result);
  if (!result.joined) return result;
  merger.close_loops();
  result.closures = merger.closures();
  result.map = merger.saved(first);
  return result;
}

}  // namespace scanlock
