// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/map_worker.hpp"

#include <string>
#include <utility>
#include <variant>

namespace scanlock {
namespace {

RecoveryAnswer nothing_found(const RecoveryRequest& request, const std::string& map_fault) {
  RecoveryAnswer answer;
  answer.serial = request.serial;
  answer.utime = request.utime;
  answer.reason = answer.map_fault = map_fault;
  return answer;
}

ClosureAnswer nothing_found(const ClosureRequest& request, const std::string& map_fault) {
  ClosureAnswer answer;
  answer.serial = request.serial;
  answer.keyframe = request.keyframe.id;
  answer.nearest = request.nearest;
  answer.nearest_keyframe = request.nearest_keyframe;
  answer.reason = answer.map_fault = map_fault;
  return answer;
}

JoinAnswer nothing_found(const JoinRequest& request, const std::string& map_fault) {
  JoinAnswer answer;
  answer.search = nothing_found(request.search, map_fault);
  answer.closure = nothing_found(request.closure, map_fault);
  return answer;
}

/// Not reported here: the searches in that target report the same fault.
std::monostate nothing_found(const SearchTarget&, const std::string&) {
  return {};
}

MapAnswer nothing_found(const MapRequest& request, const std::string& map_fault) {
  return std::visit([&](const auto& one) -> MapAnswer { return nothing_found(one, map_fault); }, request);
}

}  // namespace

MapAnswer MapWorker::work(const MapRequest& request) {
  try {
    if (const auto* recovery = std::get_if<RecoveryRequest>(&request)) return finder_.find(*recovery);
    if (const auto* join = std::get_if<JoinRequest>(&request)) return join_submaps(*join, finder_, config_);
    if (const auto* closure = std::get_if<ClosureRequest>(&request)) return close_loop(*closure, config_);
    finder_.prepare(std::get<SearchTarget>(request));
    return {};
  } catch (const PointsUnreadable& error) {
    return nothing_found(request, error.what());
  }
}

}  // namespace scanlock
