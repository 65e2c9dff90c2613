// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/message_sink.hpp"

#include "daemon/host_network.hpp"
#include "daemon/lcm_url.hpp"

namespace scanlock {
namespace {

constexpr std::chrono::seconds kRetry{1};

}  // namespace

NetworkSink::NetworkSink(std::string url, Statistics& statistics)
    : url_(std::move(url)), statistics_(statistics) {}

bool NetworkSink::connect() {
  if (lcm_) return true;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_attempt_) return false;
  next_attempt_ = now + kRetry;
  std::string why = is_multicast_url(url_) ? multicast_fault(multicast_endpoint(url_)) : "";
  if (why.empty()) {
    auto lcm = std::make_unique<lcm::LCM>(url_);
    if (lcm->good()) {
      lcm_ = std::move(lcm);
      return true;
    }
    why = "LCM refused the URL; check it";
  }
  statistics_.complain(&Counters::publish_errors, "cannot publish to " + url_ + ": " + why, 0);
  return false;
}

void NetworkSink::send(std::int64_t, const std::string& channel, const Bytes& message) {
  if (connect() && lcm_->publish(channel, message.data(), static_cast<unsigned>(message.size())) == 0) return;
  if (!lcm_) return statistics_.count(&Counters::publish_errors);  // connect() said why
  const std::string why = is_multicast_url(url_) ? multicast_fault(multicast_endpoint(url_)) : "";
  statistics_.complain(&Counters::publish_errors,
                       "publishing on " + channel + " failed" + (why.empty() ? "" : ": " + why));
}

std::unique_ptr<MessageSink> open_sink(const std::string& url, Statistics& statistics) {
  check_url(url);
  if (!is_log_url(url)) return std::make_unique<NetworkSink>(url, statistics);
  const std::string mode = url_option(url, "mode").value_or("r");
  if (mode != "w" && mode != "a")
    throw ConfigError(url + ": to write a log, end its URL with ?mode=w (or ?mode=a to append)");
  try {
    return std::make_unique<LogSink>(log_url_path(url),
                                     mode == "a" ? LogWriter::Mode::kAppend : LogWriter::Mode::kCreate);
  } catch (const std::runtime_error& error) {
    throw ConfigError(error.what());
  }
}

}  // namespace scanlock
