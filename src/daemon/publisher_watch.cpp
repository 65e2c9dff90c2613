// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/publisher_watch.hpp"

namespace scanlock {
namespace {

constexpr int kProof = 10;      // in a row that have to say so
constexpr int kSilence = 1000;  // scans

}  // namespace

bool CountWatch::interleaves(std::int32_t count, bool sector) {
  if (sector && count == last_[1]) return false;
  // Of one sender, a count goes on from the last one; of two, from the one before that.
  const std::int64_t ahead = static_cast<std::int64_t>(count) - last_[0];
  const bool other = count != 0 && (ahead == 1 || (sector && ahead == 0));
  last_ = {last_[1], count};
  interleaved_ = other ? interleaved_ + 1 : 0;
  return interleaved_ >= kProof;
}

std::string CountWatch::counts() const {
  return std::to_string(last_[0]) + " and " + std::to_string(last_[1]);
}

std::optional<std::string> PublisherWatch::look(const TrackedScan& tracked) {
  if (tracked.verdict == ScanVerdict::kTracked) {
    // The map is of one of two places: one scan fits, the next one does not, the next one fits again.
    const bool fits = tracked.method == PoseMethod::kIcp;
    alternations_ = fits != fitted_ ? alternations_ + 1 : 0;
    fitted_ = fits;
  }
  if (silence_ > 0) {
    --silence_;
    return std::nullopt;
  }
  const bool alternate = alternations_ >= kProof;
  if (!alternate && !tracked.interleaved) return std::nullopt;
  silence_ = kSilence;
  return "two publishers send scans here: " +
         (alternate ? std::string("every other scan is of another place")
                    : "their stamps are of two clocks in turn (" + tracked.why + ")") +
         "; stop one of them, or give it a channel of its own";
}

}  // namespace scanlock
