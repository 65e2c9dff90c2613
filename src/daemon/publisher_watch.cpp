// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/publisher_watch.hpp"

namespace scanlock {
namespace {

constexpr int kProof = 10;      // observations in a row that indicate two publishers
constexpr int kSilence = 1000;  // scans between two reports

}  // namespace

bool CountWatch::interleaves(std::int32_t count, bool sector) {
  if (sector && count == last_[1]) return false;
  // With one sender, a count follows the last one; with two senders in turn, it follows the one before the
  // last.
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
    // With publishers at two places, the map is of one of them: every other scan fits the map.
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
         (alternate ? std::string("every other scan is from another position")
                    : "their stamps alternate between two clocks (" + tracked.why + ")") +
         "; stop one of them, or give it a channel of its own";
}

}  // namespace scanlock
