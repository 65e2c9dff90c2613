// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Which answers of scanlock-align lead to exit code 0.
#pragma once

#include <iostream>
#include <string>

#include "align_report.hpp"
#include "global/cloud_registration.hpp"
#include "icp/cloud_alignment.hpp"

namespace scanlock {

/// Each value accepts all that the value before it accepts, and more.
enum class Acceptance { kCertain, kAmbiguous, kAny };

/// `accept`: one of the names of an Acceptance.
inline void add_accept_option(CommandLine line, std::string& accept, const std::string& description) {
  line.option("--accept", accept, description).one_of({"certain", "ambiguous", "any"});
}

inline Acceptance acceptance(const std::string& name) {
  return name == "certain" ? Acceptance::kCertain : name == "any" ? Acceptance::kAny : Acceptance::kAmbiguous;
}

/// The verdict on an answer, and its reason in words.
struct AlignVerdict {
  Acceptance least = Acceptance::kCertain;  ///< the strictest setting that accepts the answer
  std::string why;
};

inline AlignVerdict verdict_of(const CloudRegistration& found) {
  const std::string why = std::string("the verdict is ") + verdict_name(found.verdict) + ": " + found.why;
  if (found.verdict == GlobalVerdict::kCertain) return {};
  return {found.verdict == GlobalVerdict::kAmbiguous ? Acceptance::kAmbiguous : Acceptance::kAny, why};
}

inline AlignVerdict verdict_of(const CloudAlignment& found) {
  std::string axes;
  for (const Json& name : axis_names(found.degenerate_axes))
    axes += (axes.empty() ? "" : ", ") + name.get<std::string>();
  if (!axes.empty())
    return {Acceptance::kAmbiguous, "the alignment is degenerate: the clouds do not constrain " + axes};
  if (found.stop_reason == "degenerate")
    return {Acceptance::kAmbiguous,
            "the alignment is degenerate: the inlier ratio is " + std::to_string(found.inlier_ratio)};
  if (found.stop_reason == "iterations")
    return {Acceptance::kAny,
            "the alignment did not converge in " + std::to_string(found.iterations) + " iterations"};
  return {};
}

/// The exit code; for an answer that is not accepted prints the reason on standard error.
inline int judge(const AlignVerdict& verdict, const std::string& accept) {
  if (verdict.least <= acceptance(accept)) return 0;
  std::cerr << "scanlock-align: " << verdict.why << "; --accept "
            << (verdict.least == Acceptance::kAny ? "any" : "ambiguous") << " accepts it\n";
  return 1;
}

}  // namespace scanlock
