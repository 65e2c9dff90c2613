// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/event.hpp"

#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace scanlock {
namespace {

/// The whole text as a finite number >= 0; negative when it is not such a number.
double seconds_of(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = -1;
  if (!(stream >> value) || !stream.eof() || !std::isfinite(value)) return -1;
  return value;
}

}  // namespace

SimulationEvent parse_event(const std::string& text) {
  constexpr std::pair<const char*, EventKind> kNames[] = {{"kidnap", EventKind::kKidnap},
                                                          {"blackout", EventKind::kBlackout},
                                                          {"shake", EventKind::kShake},
                                                          {"halfview", EventKind::kHalfView},
                                                          {"dropout", EventKind::kDropout}};
  const auto fail = [&](const std::string& what) {
    throw std::invalid_argument("event '" + text + "': " + what);
  };
  const std::size_t at = text.find('@'), plus = text.find('+', at == std::string::npos ? 0 : at);
  SimulationEvent event;
  bool known = false;
  for (const auto& [name, kind] : kNames)
    if (text.substr(0, at) == name) {
      event.kind = kind;
      known = true;
    }
  if (!known) fail("the kinds are kidnap, blackout, shake, halfview and dropout");
  if (at == std::string::npos) fail("the time is missing, write for instance kidnap@20");

  event.time_s = seconds_of(text.substr(at + 1, plus == std::string::npos ? plus : plus - at - 1));
  if (event.time_s < 0) fail("the time after @ must be seconds from the start, 0 or more");
  if (event.kind == EventKind::kKidnap) {
    if (plus != std::string::npos) fail("a kidnap has no duration, write kidnap@T");
    return event;
  }
  if (plus == std::string::npos) fail("the duration is missing, write for instance shake@20+2");
  event.duration_s = seconds_of(text.substr(plus + 1));
  if (event.duration_s <= 0) fail("the duration after + must be seconds, more than 0");
  return event;
}

}  // namespace scanlock
