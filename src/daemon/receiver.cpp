// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/receiver.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <stdexcept>

#include "daemon/host_network.hpp"
#include "daemon/lcm_self_test.hpp"
#include "daemon/lcm_url.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

/// Messages in LCM's own queue, which drops the newest when it is full. The queue stays short because the
/// handler is quick, but the sectors of a whole scan may arrive in one burst and have to fit. (0 would mean
/// no limit.)
constexpr int kQueueCapacity = 64;
constexpr int kPriorCapacity = 1000;  // small messages, at most a thousand per second
constexpr std::chrono::milliseconds kFirstRetry{250}, kLastRetry{8000};
constexpr std::chrono::milliseconds kSocketPeriod{500};

}  // namespace

Receiver::Receiver(const DaemonConfig& config, WorkInbox& inbox, Statistics& statistics,
                   const StopSignal& stop)
    : config_(config),
      url_(input_url(config)),
      inbox_(inbox),
      statistics_(statistics),
      stop_(stop),
      intake_(config, statistics) {}

void Receiver::run() {
  while (!stop_.requested()) {
    const std::unique_ptr<lcm::LCM> lcm = connect();
    if (!lcm) break;
    listen(*lcm);
    watch_sockets();
    sockets_.clear();
    if (stop_.wait_for(kFirstRetry)) break;  // the connection broke: reconnect after a pause
  }
  inbox_.finish();
}

std::unique_ptr<lcm::LCM> Receiver::connect() {
  std::string reported;
  for (auto pause = kFirstRetry; !stop_.requested(); pause = std::min(pause * 2, kLastRetry)) {
    if (auto lcm = try_connect()) {
      if (!reported.empty()) statistics_.say(LogLevel::kInfo, "receiving from " + url_ + " now");
      return lcm;
    }
    if (!is_multicast_url(url_)) throw std::runtime_error(url_ + ": LCM refuses this URL; check it");
    std::string why = multicast_fault(multicast_endpoint(url_));
    if (why.empty()) why = self_test_fault(multicast_endpoint(url_));
    if (why != reported) {
      statistics_.complain("cannot receive from " + url_ + ": " + why + " (trying again until it works)");
      reported = why;
    }
    stop_.wait_for(pause);
  }
  return nullptr;
}

std::unique_ptr<lcm::LCM> Receiver::try_connect() {
  // Without a route, LCM 1.3.1 prints a screenful of text at each attempt; connect() reports the cause in one
  // line instead.
  if (is_multicast_url(url_) && !multicast_fault(multicast_endpoint(url_)).empty()) return nullptr;
  const int port = is_multicast_url(url_) ? multicast_endpoint(url_).port : 0;
  const std::set<int> before = udp_sockets_on(port);
  auto lcm = std::make_unique<lcm::LCM>(url_);
  if (!lcm->good() || !passes_self_test(*lcm, url_)) return nullptr;
  subscribe(*lcm);
  if (!is_multicast_url(url_)) return lcm;
  settle_receive_buffer(before, port);
  return lcm;
}

void Receiver::subscribe(lcm::LCM& lcm) {
  const auto listen_to = [&](const std::string& channel, int capacity) {
    lcm.subscribe(literal_pattern(channel), &Receiver::on_message, this)->setQueueCapacity(capacity);
  };
  for (const std::string& channel : config_.scan_channels) listen_to(channel, kQueueCapacity);
  if (!config_.command_channel.empty()) listen_to(config_.command_channel, kQueueCapacity);
  for (const std::string& channel : intake_.prior_channels()) listen_to(channel, kPriorCapacity);
}

void Receiver::settle_receive_buffer(const std::set<int>& before, int port) {
  const std::set<int> after = udp_sockets_on(port);
  sockets_.clear();
  drops_counted_ = 0;
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::inserter(sockets_, sockets_.end()));
  const int wanted = wanted_receive_buffer(url_);
  for (const int fd : sockets_) {
    if (granted_receive_buffer(fd) < wanted) force_receive_buffer(fd, wanted);
    const int granted = granted_receive_buffer(fd);
    statistics_.set_receive_buffer(wanted, granted);
    if (granted >= wanted) continue;
    statistics_.say(LogLevel::kWarning, "the kernel grants " + std::to_string(granted) + " of " +
                                            std::to_string(wanted) +
                                            " bytes of receive buffer; larger scans will be lost; " +
                                            "run: sysctl -w net.core.rmem_max=" + std::to_string(wanted));
  }
}

void Receiver::listen(lcm::LCM& lcm) {
  auto next_look = Clock::now() + kSocketPeriod;
  while (!stop_.requested()) {
    const int fd = lcm.getFileno();
    if (fd < 0) {  // tcpq without a server: handle() tries to connect and prints its own messages
      if (lcm.handle() < 0) return;
      continue;
    }
    const auto event = stop_.wait_for_input(fd, kSocketPeriod);
    if (event == StopSignal::Event::kInput && lcm.handle() < 0) return;  // the connection broke
    if (Clock::now() >= next_look) {
      watch_sockets();
      next_look = Clock::now() + kSocketPeriod;
    }
  }
}

void Receiver::on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  // An exception that leaves a handler makes LCM abort at the next message.
  try {
    const auto* data = static_cast<const std::uint8_t*>(buffer->data);
    for (Intake::Item& item : intake_.take(channel, data, buffer->data_size, utime_now()))
      std::visit([this](auto& arrived) { hand_over(std::move(arrived)); }, item);
  } catch (const std::exception& error) {
    statistics_.count_fault(DecodeFault::kBadSize, channel + ": " + error.what());
  } catch (...) {
    statistics_.count_fault(DecodeFault::kBadSize, channel + ": unknown exception");
  }
}

void Receiver::hand_over(ReceivedScan&& scan) {
  const bool empty = scan.scan.points.empty();  // an empty scan must not replace a usable one
  if (empty ? !inbox_.offer(std::move(scan)) : inbox_.replace(std::move(scan)))
    statistics_.count(&Counters::replaced);
}

void Receiver::hand_over(Command&& command) {
  if (!inbox_.post(std::move(command)))
    statistics_.complain(&Counters::commands_rejected,
                         config_.command_channel + ": too many commands wait already");
}

void Receiver::watch_sockets() {
  std::int64_t drops = 0;
  for (const int fd : sockets_) drops += kernel_drops(fd).value_or(0);
  const std::int64_t fresh = drops - drops_counted_;
  if (fresh <= 0) return;
  drops_counted_ = drops;
  statistics_.complain(&Counters::kernel_drops,
                       "the kernel dropped " + std::to_string(fresh) +
                           " datagrams: the receive buffer is too small or the machine too busy; scanlockd "
                           "--check says more",
                       fresh);
}

}  // namespace scanlock
