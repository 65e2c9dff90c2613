// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/intake.hpp"

#include <utility>

#include "messages/decode_report.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

Intake::Intake(const DaemonConfig& config, Statistics& statistics)
    : command_channel_(config.command_channel),
      limits_{static_cast<std::size_t>(config.max_message_bytes), static_cast<std::size_t>(config.max_points),
              config.mbot_clockwise, config.planar_no_return_m},
      statistics_(statistics),
      priors_(config) {
  for (const std::string& channel : config.scan_channels)
    assemblers_.emplace(channel, SectorAssembler(limits_.max_points));
}

std::vector<Intake::Item> Intake::take(const std::string& channel, const std::uint8_t* data, std::size_t size,
                                       std::int64_t utime) {
  std::vector<Item> items;
  const auto assembler = assemblers_.find(channel);
  if (assembler != assemblers_.end()) {
    ReceivedScan received;
    received.arrival = Clock::now();
    received.recv_utime = utime;
    DecodedScan decoded = decode_scan(data, size, limits_);
    const std::int64_t discarded = assembler->second.discarded_sectors();
    if (decoded.fault == DecodeFault::kNone) watch_counts(channel, decoded);
    for (DecodedScan& scan : assembler->second.add(std::move(decoded)))
      take_scan(channel, std::move(scan), received, items);
    count_sectors(channel, assembler->second, discarded);
  } else if (!command_channel_.empty() && channel == command_channel_) {
    const auto command = decode_command(data, size);
    if (command.ok())
      items.emplace_back(command.value);
    else
      statistics_.complain(&Counters::commands_rejected, channel + ": " + command.error);
  } else if (const auto fault = priors_.take(channel, data, size)) {
    statistics_.complain(&Counters::priors_rejected, *fault);
  }
  return items;
}

std::vector<Intake::Item> Intake::finish(std::int64_t utime) {
  std::vector<Item> items;
  for (auto& [channel, assembler] : assemblers_) {
    std::optional<DecodedScan> incomplete = assembler.flush();
    if (!incomplete) continue;
    ReceivedScan received;
    received.arrival = Clock::now();
    received.recv_utime = utime;
    take_scan(channel, std::move(*incomplete), received, items);
  }
  return items;
}

void Intake::count_sectors(const std::string& channel, const SectorAssembler& assembler,
                           std::int64_t before) {
  const std::int64_t discarded = assembler.discarded_sectors() - before;
  if (discarded > 0)
    statistics_.complain(&Counters::sectors_discarded,
                         channel + ": a sector was discarded: " + assembler.last_discarded(), discarded);
}

void Intake::watch_counts(const std::string& channel, const DecodedScan& decoded) {
  if (decoded.is_sector()) statistics_.count(&Counters::sectors);
  CountWatch& watch = counts_[channel];
  if (watch.interleaves(decoded.seq, decoded.is_sector()))
    statistics_.complain(&Counters::two_publishers,
                         channel + ": two publishers send scans here: they are counted in turn, " +
                             watch.counts() + "; stop one of them, or give it a channel of its own");
}

void Intake::take_scan(const std::string& channel, DecodedScan decoded, ReceivedScan received,
                       std::vector<Item>& items) {
  statistics_.count_received();
  if (decoded.fault != DecodeFault::kNone)
    return statistics_.count_fault(decoded.fault, channel + ": " + decoded.error);
  statistics_.count(&Counters::nonfinite_points, static_cast<std::int64_t>(decoded.nonfinite_points));
  if (decoded.sectors_missing > 0)
    statistics_.complain(&Counters::incomplete, channel + ": a scan came without " +
                                                    std::to_string(decoded.sectors_missing) + " of its " +
                                                    std::to_string(decoded.sector_count) + " sectors");
  say_how_times_are_read(channel, decoded);
  received.scan = std::move(decoded.scan);
  received.seq = decoded.seq;
  stamp(channel, received);
  PriorIntake::Reading reading = priors_.read(received.scan.utime);
  received.prior = std::move(reading.sample);
  if (!reading.fault.empty()) statistics_.complain(&Counters::priors_absent, "prior: " + reading.fault);
  received.decode_ms = std::chrono::duration<double, std::milli>(Clock::now() - received.arrival).count();
  items.emplace_back(std::move(received));
}

void Intake::stamp(const std::string& channel, ReceivedScan& received) {
  if (received.scan.utime > 0) return;
  received.scan.utime = received.recv_utime;
  received.scan.stamped_by_arrival = true;
  statistics_.complain(&Counters::without_time,
                       channel + ": the scan has no time (utime <= 0); its time of arrival was taken");
}

void Intake::say_how_times_are_read(const std::string& channel, const DecodedScan& decoded) {
  const bool untimed = !decoded.scan.points.empty() && !decoded.scan.points.has_times();
  if (untimed) statistics_.count(&Counters::without_point_times);
  std::string& said = times_said_[channel];
  const std::string sentence = channel + ": " + decoded.type + ", times of points: " +
                               (decoded.time_field.empty() ? "none" : decoded.time_field);
  if (said == sentence || decoded.scan.points.empty()) return;
  said = sentence;
  if (!untimed) return statistics_.say(LogLevel::kInfo, sentence);
  statistics_.complain(&Counters::without_point_times,
                       sentence +
                           "; unless the scans are motion-compensated already, poses are several times "
                           "less accurate while the robot moves; publish a time for each point",
                       0);
}

}  // namespace scanlock
