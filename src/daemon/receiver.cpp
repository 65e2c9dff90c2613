// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/receiver.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "daemon/host_network.hpp"
#include "daemon/lcm_url.hpp"
#include "messages/decode_report.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

/// LCM's own queue keeps the oldest; it stays short because the handler is quick. The sectors of a whole scan
/// may come in one burst and have to fit (0 would mean no limit).
constexpr int kQueueCapacity = 64;
constexpr int kPriorCapacity = 1000;  // small messages, a thousand a second at most
constexpr std::chrono::milliseconds kFirstRetry{250}, kLastRetry{8000};
constexpr std::chrono::milliseconds kSocketPeriod{500};

}  // namespace

Receiver::Receiver(const DaemonConfig& config, WorkInbox& inbox, Statistics& statistics,
                   const StopSignal& stop)
    : config_(config),
      url_(input_url(config)),
      from_log_(is_log_url(url_)),
      inbox_(inbox),
      statistics_(statistics),
      stop_(stop),
      limits_{static_cast<std::size_t>(config.max_message_bytes), static_cast<std::size_t>(config.max_points),
              config.mbot_clockwise},
      priors_(config) {
  for (const auto& channel : config.scan_channels)
    assemblers_.emplace(channel, SectorAssembler(limits_.max_points));
}

void Receiver::run() {
  while (!stop_.requested()) {
    const std::unique_ptr<lcm::LCM> lcm = connect();
    if (!lcm) break;
    listen(*lcm);
    watch_sockets();
    sockets_.clear();
    if (from_log_) {
      flush();
      break;
    }
    if (stop_.wait_for(kFirstRetry)) break;  // the link broke: a new one after a breath
  }
  inbox_.finish();
}

std::unique_ptr<lcm::LCM> Receiver::connect() {
  std::string reported;
  for (auto pause = kFirstRetry; !stop_.requested(); pause = std::min(pause * 2, kLastRetry)) {
    if (auto lcm = try_connect()) {
      if (!reported.empty()) log_line(LogLevel::kInfo, "receiving from " + url_ + " now");
      return lcm;
    }
    if (from_log_) throw std::runtime_error(url_ + ": this log cannot be read; check its path");
    std::string why = is_multicast_url(url_) ? multicast_fault(multicast_endpoint(url_)) : "";
    if (why.empty()) why = "LCM refused the URL; check it";
    if (why != reported) {
      log_line(LogLevel::kWarning,
               "cannot receive from " + url_ + ": " + why + " (trying again until it works)");
      statistics_.set_error("cannot receive from " + url_ + ": " + why);
      reported = why;
    }
    stop_.wait_for(pause);
  }
  return nullptr;
}

std::unique_ptr<lcm::LCM> Receiver::try_connect() {
  // LCM 1.3.1 prints a screenful for a missing route at each attempt; we know the answer and say it in one
  // line.
  if (is_multicast_url(url_) && !multicast_fault(multicast_endpoint(url_)).empty()) return nullptr;
  const int port = is_multicast_url(url_) ? multicast_endpoint(url_).port : 0;
  const std::set<int> before = udp_sockets_on(port);
  auto lcm = std::make_unique<lcm::LCM>(url_);
  if (!lcm->good()) return nullptr;
  for (const auto& channel : config_.scan_channels) {
    lcm->subscribe(literal_pattern(channel), &Receiver::on_message, this)->setQueueCapacity(kQueueCapacity);
  }
  if (!config_.command_channel.empty())
    lcm->subscribe(literal_pattern(config_.command_channel), &Receiver::on_command, this);
  for (const auto& channel : priors_.channels())
    lcm->subscribe(literal_pattern(channel), &Receiver::on_prior, this)->setQueueCapacity(kPriorCapacity);
  if (is_multicast_url(url_) && lcm->getFileno() < 0) return nullptr;
  if (!is_multicast_url(url_)) return lcm;

  const std::set<int> after = udp_sockets_on(port);
  sockets_.clear();
  drops_counted_ = 0;
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::inserter(sockets_, sockets_.end()));
  const int wanted = wanted_receive_buffer(url_);
  for (const int fd : sockets_) {
    if (granted_receive_buffer(fd) < wanted) force_receive_buffer(fd, wanted);
    statistics_.set_receive_buffer(wanted, granted_receive_buffer(fd));
    if (granted_receive_buffer(fd) >= wanted) continue;
    log_line(LogLevel::kWarning, "the kernel grants " + std::to_string(granted_receive_buffer(fd)) + " of " +
                                     std::to_string(wanted) +
                                     " bytes of receive buffer; larger scans will be lost; " +
                                     "run: sysctl -w net.core.rmem_max=" + std::to_string(wanted));
  }
  return lcm;
}

void Receiver::listen(lcm::LCM& lcm) {
  auto next_look = Clock::now() + kSocketPeriod;
  while (!stop_.requested()) {
    const int fd = lcm.getFileno();
    if (fd < 0) {  // tcpq without a server: handle() tries to connect, and says so itself
      if (lcm.handle() < 0) return;
      continue;
    }
    const auto event = stop_.wait_for_input(fd, kSocketPeriod);
    if (event == StopSignal::Event::kInput && lcm.handle() < 0) return;  // end of the log, or the link broke
    if (Clock::now() >= next_look) {
      watch_sockets();
      next_look = Clock::now() + kSocketPeriod;
    }
  }
}

void Receiver::on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  // An exception that leaves a handler makes LCM abort at the next message.
  try {
    on_bytes(*buffer, channel);
  } catch (const std::exception& error) {
    reject(DecodeFault::kBadSize, channel + ": " + error.what());
  } catch (...) {
    reject(DecodeFault::kBadSize, channel + ": unknown exception");
  }
}

void Receiver::on_command(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  try {
    const auto command = decode_command(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (!command.ok()) return reject_command(channel + ": " + command.error);
    if (!inbox_.post(command.value)) reject_command(channel + ": too many commands wait already");
  } catch (const std::exception& error) {
    reject_command(channel + ": " + error.what());
  }
}

void Receiver::on_prior(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  try {
    const auto sentence =
        priors_.take(channel, static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (sentence) complain_of_prior(&Counters::priors_rejected, *sentence);
  } catch (const std::exception& error) {
    complain_of_prior(&Counters::priors_rejected, channel + ": " + error.what());
  }
}

void Receiver::on_bytes(const lcm::ReceiveBuffer& buffer, const std::string& channel) {
  ReceivedScan received;
  received.arrival = Clock::now();
  received.recv_utime = utime_now();
  statistics_.count_received(buffer.data_size);
  DecodedScan decoded = decode_scan(static_cast<const std::uint8_t*>(buffer.data), buffer.data_size, limits_);
  for (DecodedScan& scan : assemblers_.at(channel).add(std::move(decoded))) {
    on_scan(std::move(scan), received, channel);
  }
}

void Receiver::on_scan(DecodedScan decoded, ReceivedScan received, const std::string& channel) {
  statistics_.count(&Counters::nonfinite_points, static_cast<std::int64_t>(decoded.nonfinite_points));
  if (decoded.sectors_missing > 0) statistics_.count(&Counters::incomplete);
  if (decoded.fault != DecodeFault::kNone) return reject(decoded.fault, channel + ": " + decoded.error);
  if (decoded.scan.points.empty()) {  // it must not replace a good scan in the slot
    statistics_.count(&Counters::empty);
    return reject(DecodeFault::kNone, channel + ": a scan without a single usable point");
  }
  say_how_times_are_read(decoded, channel);
  received.scan = std::move(decoded.scan);
  received.seq = decoded.seq;
  if (received.scan.utime <= 0) {
    received.scan.utime = received.recv_utime;
    statistics_.count(&Counters::without_time);
    statistics_.set_error(channel + ": the scan has no time (utime <= 0); its time of arrival was taken");
    if (untimed_.allows(received.arrival)) {
      log_line(LogLevel::kWarning,
               channel + ": scans without a time (utime <= 0); their time of arrival is taken");
    }
  }
  PriorIntake::Reading reading = priors_.read(received.scan.utime);
  received.prior = std::move(reading.sample);
  if (!reading.fault.empty()) complain_of_prior(&Counters::priors_absent, "prior: " + reading.fault);
  received.decode_ms = milliseconds(Clock::now() - received.arrival);
  if (from_log_) {
    inbox_.put(std::move(received));
  } else if (inbox_.replace(std::move(received))) {
    statistics_.count(&Counters::replaced);
  }
}

void Receiver::flush() {
  for (auto& [channel, assembler] : assemblers_) {
    if (auto incomplete = assembler.flush()) {
      ReceivedScan received;
      received.arrival = Clock::now();
      received.recv_utime = utime_now();
      on_scan(std::move(*incomplete), received, channel);
    }
  }
}

void Receiver::say_how_times_are_read(const DecodedScan& decoded, const std::string& channel) {
  std::string& said = times_said_[channel];
  const std::string sentence =
      decoded.type + ", times of points: " + (decoded.time_field.empty() ? "none" : decoded.time_field);
  if (said == sentence || !times_.allows(Clock::now())) return;
  said = sentence;
  log_line(LogLevel::kInfo, channel + ": " + sentence);
}

void Receiver::reject(DecodeFault fault, const std::string& sentence) {
  statistics_.count_fault(fault, sentence);
  statistics_.set_error(sentence);
  if (!rejections_.allows(Clock::now())) return;
  const long more = rejections_.suppressed();
  log_line(LogLevel::kWarning,
           "rejected: " + sentence + (more > 0 ? " (and " + std::to_string(more) + " before it)" : ""));
}

void Receiver::reject_command(const std::string& sentence) {
  statistics_.count(&Counters::commands_rejected);
  statistics_.set_error(sentence);
  if (rejections_.allows(Clock::now())) log_line(LogLevel::kWarning, "command rejected: " + sentence);
}

void Receiver::complain_of_prior(std::int64_t Counters::*counter, const std::string& sentence) {
  statistics_.count(counter);
  if (!prior_faults_.allows(Clock::now())) return;  // at hundreds a second they would hide every other error
  statistics_.set_error(sentence);
  log_line(LogLevel::kWarning, sentence);
}

void Receiver::watch_sockets() {
  std::int64_t drops = 0;
  for (const int fd : sockets_) drops += kernel_drops(fd).value_or(0);
  const std::int64_t fresh = drops - drops_counted_;
  if (fresh <= 0) return;
  drops_counted_ = drops;
  statistics_.count(&Counters::kernel_drops, fresh);
  const std::string sentence =
      "the kernel dropped " + std::to_string(fresh) +
      " datagrams: the receive buffer is too small or the machine too busy; scanlockd --check says more";
  statistics_.set_error(sentence);
  if (drops_.allows(Clock::now())) log_line(LogLevel::kWarning, sentence);
}

}  // namespace scanlock
