// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/doctor.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "daemon/host_network.hpp"
#include "daemon/lcm_self_test.hpp"
#include "daemon/lcm_url.hpp"
#include "daemon/stop_signal.hpp"
#include "io/lcm_log.hpp"
#include "messages/fingerprints.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;
using Grade = Finding::Grade;

constexpr int kEchoBytes = 2000000;  // bytes of a scan of 125,000 points of 16 bytes
constexpr int kEchoes = 5;
constexpr std::chrono::milliseconds kEchoPeriod{100}, kListen{2000};
constexpr std::chrono::milliseconds kEchoPatience{3000};  // a late echo on a busy machine is not lost
constexpr std::size_t kMaxHeard = 100;

/// Records every message that arrives, and counts the echoes of the doctor's own messages.
class Listener {
 public:
  explicit Listener(std::string echo_channel) : echo_channel_(std::move(echo_channel)) {}

  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    if (channel == echo_channel_) {
      if (buffer->data_size == kEchoBytes) ++echoes_;
      return;
    }
    if (channel != "LCM_SELF_TEST")
      note(channel, static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  }

  /// Records a message; returns whether it is a scan.
  bool note(const std::string& channel, const std::uint8_t* data, std::size_t size) {
    if (heard_.size() >= kMaxHeard && heard_.count(channel) == 0) return false;
    HeardChannel& heard = heard_[channel];
    const std::uint64_t print = message_fingerprint(data, size);
    heard.name = channel;
    heard.type = name_of_type(print);
    heard.holds_scans = is_scan_type(print);
    heard.largest_bytes = std::max(heard.largest_bytes, size);
    ++heard.messages;
    return heard.holds_scans;
  }

  /// Handles messages until `duration` has passed, or all awaited echoes have arrived.
  void listen(lcm::LCM& lcm, Clock::duration duration, int echoes_awaited) {
    const auto end = Clock::now() + duration;
    while (Clock::now() < end && (echoes_awaited == 0 || echoes_ < echoes_awaited)) {
      const int fd = lcm.getFileno();
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
      if (fd < 0 || never_.wait_for_input(fd, left) != StopSignal::Event::kInput || lcm.handle() < 0) return;
    }
  }

  int echoes() const { return echoes_; }
  std::vector<HeardChannel> heard() const {
    std::vector<HeardChannel> all;
    for (const auto& [name, channel] : heard_) all.push_back(channel);
    return all;
  }

 private:
  static std::string name_of_type(std::uint64_t print) {
    if (const char* name = type_name(print)) return name;
    char text[24];
    std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(print));
    return text;
  }

  StopSignal never_;
  std::string echo_channel_;
  int echoes_ = 0;
  std::map<std::string, HeardChannel> heard_;
};

void add(DoctorReport& report, Grade grade, const char* name, std::string detail, std::string remedy = "") {
  const bool for_root = remedy.rfind("ip ", 0) == 0 || remedy.rfind("sysctl ", 0) == 0;
  if (for_root && geteuid() != 0) remedy.insert(0, "sudo ");
  report.findings.push_back({grade, name, std::move(detail), std::move(remedy)});
}

/// The command that enlarges the buffer: if the URL asks for too little, another URL; otherwise a kernel
/// setting.
std::string buffer_remedy(const std::string& url, int wanted) {
  if (wanted >= kEchoBytes) return "sysctl -w net.core.rmem_max=" + std::to_string(wanted);
  const std::size_t begin = url.find("recv_buf_size=");
  const std::size_t end = std::min(url.find_first_of("&,", begin), url.size());
  return "scanlockd -l '" + url.substr(0, begin) + "recv_buf_size=8388608" + url.substr(end) + "'";
}

void examine_route(const std::string& url, DoctorReport& report) {
  const MulticastEndpoint endpoint = multicast_endpoint(url);
  if (loopback_is_up()) {
    add(report, Grade::kGood, "loopback", "the loopback interface is up");
  } else {
    add(report, Grade::kFault, "loopback", "the loopback interface is down", "ip link set lo up");
  }
  const MulticastRoute route = multicast_route(endpoint);
  if (!route.exists) {
    add(report, Grade::kFault, "route", "no multicast route to " + endpoint.address,
        "ip route add 224.0.0.0/4 dev lo");
  } else if (!route.on_loopback && url_option(url, "ttl").value_or("0") == "0") {
    add(report, Grade::kNote, "route",
        "multicast for this host only (ttl=0) leaves through the interface of " + route.local_address +
            "; through the loopback it needs fewer datagrams",
        "ip route add 224.0.0.0/4 dev lo");
  } else {
    add(report, Grade::kGood, "route",
        "multicast to " + endpoint.address + " leaves through " +
            (route.on_loopback ? "the loopback" : "the interface of " + route.local_address));
  }
}

void examine_buffer(const std::set<int>& sockets, const std::string& url, DoctorReport& report) {
  const int wanted = wanted_receive_buffer(url);
  int granted = 0;
  for (const int fd : sockets) {
    if (granted_receive_buffer(fd) < wanted) force_receive_buffer(fd, wanted);
    granted = granted_receive_buffer(fd);
  }
  report.recv_buf_wanted = wanted;
  report.recv_buf_granted = granted;
  report.rmem_max = kernel_setting("net/core/rmem_max").value_or(0);
  const std::string detail = "receive buffer: " + std::to_string(wanted) + " bytes wanted, " +
                             std::to_string(granted) + " granted (net.core.rmem_max is " +
                             std::to_string(report.rmem_max) + ")";
  const std::string remedy = buffer_remedy(url, wanted);
  if (granted < kEchoBytes) {
    add(report, Grade::kFault, "receive_buffer",
        detail + "; scans over " + std::to_string(granted) + " bytes are lost", remedy);
  } else {
    add(report, granted < wanted ? Grade::kNote : Grade::kGood, "receive_buffer", detail,
        granted < wanted ? remedy : "");
  }
  const std::int64_t rmem_default = kernel_setting("net/core/rmem_default").value_or(0);
  if (rmem_default < kEchoBytes) {
    add(report, Grade::kNote, "default_buffer",
        "programs that ask for no buffer (lcm-logger without recv_buf_size in --lcm-url, lcm-spy) get " +
            std::to_string(rmem_default) + " bytes and lose scans",
        "sysctl -w net.core.rmem_default=8388608");
  }
}

void examine_echo(lcm::LCM& lcm, Listener& listener, const std::string& channel, const std::set<int>& sockets,
                  DoctorReport& report) {
  // A second LCM instance publishes, as a driver would. A process loses its own messages as often as those of
  // other processes.
  lcm::LCM speaker(report.url);
  const std::vector<std::uint8_t> message(kEchoBytes, 0x5a);
  for (int i = 0; i < kEchoes && speaker.good(); ++i) {
    if (speaker.publish(channel, message.data(), kEchoBytes) == 0) ++report.echoes_sent;
    listener.listen(lcm, i + 1 < kEchoes ? kEchoPeriod : kEchoPatience, i + 1);
  }
  report.echoes_received = listener.echoes();
  for (const int fd : sockets) report.kernel_drops += kernel_drops(fd).value_or(0);
  const std::string detail = std::to_string(report.echoes_received) + " of " + std::to_string(kEchoes) +
                             " messages of 2 MB to itself came back, " + std::to_string(report.kernel_drops) +
                             " datagrams dropped by the kernel";
  const bool good = report.echoes_received == kEchoes && report.kernel_drops == 0;
  add(report, good ? Grade::kGood : Grade::kFault, "echo", detail,
      good || !is_multicast_url(report.url) ? ""
                                            : buffer_remedy(report.url, wanted_receive_buffer(report.url)));
}

/// Names the other channels that carry scans, for a sentence.
std::string scans_elsewhere(const DoctorReport& report) {
  std::string names;
  for (const HeardChannel& heard : report.heard)
    if (heard.holds_scans) names += (names.empty() ? "" : ", ") + heard.name + " (" + heard.type + ")";
  if (!names.empty()) return "; scans are on " + names;
  return std::string(", and no other channel carries scans") +
         (is_log_url(report.url) ? "" : "; is a driver publishing, on this URL?");
}

std::string remedy_for_silence(const DoctorReport& report) {
  for (const HeardChannel& heard : report.heard)
    if (heard.holds_scans) return "scanlockd --scan-channel '" + heard.name + "'";
  return "";
}

/// `where`: "while listening", "in the log".
void judge_channels(const DaemonConfig& config, const std::string& where, DoctorReport& report) {
  for (const auto& channel : config.scan_channels) {
    const auto heard = std::find_if(report.heard.begin(), report.heard.end(),
                                    [&](const HeardChannel& candidate) { return candidate.name == channel; });
    if (heard == report.heard.end()) {
      add(report, Grade::kFault, "scans",
          "nothing came on " + channel + " " + where + scans_elsewhere(report), remedy_for_silence(report));
    } else if (!heard->holds_scans) {
      add(report, Grade::kFault, "scans",
          channel + " carries " + heard->type + ", which is no scan" + scans_elsewhere(report),
          remedy_for_silence(report));
    } else {
      add(report, Grade::kGood, "scans",
          channel + " carries " + heard->type + ", up to " + std::to_string(heard->largest_bytes) + " bytes");
    }
  }
}

void examine_channels(lcm::LCM& lcm, Listener& listener, const DaemonConfig& config, DoctorReport& report) {
  listener.listen(lcm, kListen, 0);
  report.listened_s = std::chrono::duration<double>(kListen).count();
  report.heard = listener.heard();
  judge_channels(config, "while listening", report);
}

/// Reads the log until every scan channel has carried a scan, or to its end.
void examine_log(const std::string& path, const DaemonConfig& config, DoctorReport& report) {
  Listener listener("");
  try {
    check_log(path);
    LogReader reader(path);
    std::set<std::string> awaited(config.scan_channels.begin(), config.scan_channels.end());
    while (!awaited.empty()) {
      const std::optional<LogEvent> event = reader.next();
      if (!event) break;
      if (listener.note(event->channel, event->data.data(), event->data.size()))
        awaited.erase(event->channel);
    }
  } catch (const std::runtime_error& error) {
    return add(report, Grade::kFault, "log", error.what());
  }
  add(report, Grade::kGood, "log", path + " can be read; a replay loses nothing");
  report.heard = listener.heard();
  judge_channels(config, "in the log", report);
}

}  // namespace

bool DoctorReport::good() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.grade == Grade::kFault; });
}

DoctorReport examine(const DaemonConfig& config) {
  DoctorReport report;
  report.url = input_url(config);
  check_url(report.url);
  if (is_log_url(report.url)) {
    examine_log(log_url_path(report.url), config, report);
    return report;
  }
  if (is_multicast_url(report.url)) {
    examine_route(report.url, report);
    const std::string fault = multicast_fault(multicast_endpoint(report.url));
    if (report.good() && !fault.empty()) add(report, Grade::kFault, "address", fault);
    if (!report.good()) return report;  // LCM would only print a long text of its own
  }
  const int port = is_multicast_url(report.url) ? multicast_endpoint(report.url).port : 0;
  const std::set<int> before = udp_sockets_on(port);
  const std::string channel = "SCANLOCK_CHECK_" + std::to_string(getpid());
  Listener listener(channel);
  lcm::LCM lcm(report.url);
  if (!lcm.good()) {
    add(report, Grade::kFault, "lcm", "LCM refused the URL " + report.url);
    return report;
  }
  if (!passes_self_test(lcm, report.url)) {
    if (is_multicast_url(report.url))
      add(report, Grade::kFault, "self_test", self_test_fault(multicast_endpoint(report.url)),
          "nft list ruleset");
    else
      add(report, Grade::kFault, "self_test", "LCM cannot receive from " + report.url);
    return report;
  }
  lcm.subscribe(".*", &Listener::on_message, &listener)->setQueueCapacity(8);
  std::set<int> sockets;
  if (is_multicast_url(report.url)) {
    const std::set<int> after = udp_sockets_on(port);
    std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                        std::inserter(sockets, sockets.end()));
    examine_buffer(sockets, report.url, report);
  }
  examine_echo(lcm, listener, channel, sockets, report);
  examine_channels(lcm, listener, config, report);
  return report;
}

std::string print_report(const DoctorReport& report) {
  std::string out = "url   " + report.url + "\n";
  for (const auto& finding : report.findings) {
    out += finding.grade == Grade::kGood ? "ok    " : finding.grade == Grade::kNote ? "note  " : "FAULT ";
    out += finding.detail + "\n";
    if (!finding.remedy.empty()) out += "      run: " + finding.remedy + "\n";
  }
  for (const auto& heard : report.heard) {
    out += "heard " + heard.name + ": " + std::to_string(heard.messages) + " messages of " + heard.type +
           ", up to " + std::to_string(heard.largest_bytes) + " bytes\n";
  }
  return out + (report.good() ? "scans arrive\n"
                              : "scans are missing or would be lost: see what stands at each FAULT\n");
}

}  // namespace scanlock
