// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "command_line.hpp"
#include "daemon/config.hpp"
#include "daemon/daemon.hpp"
#include "daemon/doctor.hpp"
#include "daemon/lcm_url.hpp"
#include "daemon/log.hpp"
#include "daemon/map_store.hpp"
#include "io/destination.hpp"
#include "io/lcm_log.hpp"
#include "io/output_files.hpp"

namespace {

using namespace scanlock;

struct Options {
  std::string config_path, url, out_url, pose_channel, map_file;
  std::vector<std::string> scan_channels;
  int threads = 0;
  bool check = false, print = false, json = false, force = false;
};

/// Turns SIGINT and SIGTERM into the stop signal. Both are blocked in every thread, so that they never
/// interrupt a system call of LCM, and one thread waits for them.
class SignalThread {
 public:
  /// `unsaved`: there is a map to save, so that an end without saving is a failure.
  SignalThread(StopSignal& stop, bool unsaved) : stop_(stop), unsaved_(unsaved) {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    signal_fd_ = signalfd(-1, &signals, SFD_CLOEXEC);
    thread_ = std::thread([this] { wait(); });
  }
  ~SignalThread() {
    ended_.request();
    thread_.join();
    close(signal_fd_);
  }
  SignalThread(const SignalThread&) = delete;
  SignalThread& operator=(const SignalThread&) = delete;

 private:
  void wait() {
    if (ended_.wait_for_input(signal_fd_, std::chrono::hours(24 * 365)) != StopSignal::Event::kInput) return;
    stop_.request();
    // A clean end takes the work on one scan and the saving of the map. A robot that shuts down waits 900 ms
    // at most, whatever delays the end: a peer that does not read, or a slow disk.
    if (ended_.wait_for(std::chrono::milliseconds(900))) return;
    log_line(LogLevel::kWarning, unsaved_
                                     ? "ended before the work in progress was done: the map was not saved"
                                     : "ended before the work in progress was done");
    std::_Exit(unsaved_ ? 1 : 0);
  }

  StopSignal& stop_;
  const bool unsaved_;
  StopSignal ended_;
  int signal_fd_ = -1;
  std::thread thread_;
};

Config configured(const Options& options) {
  Config config = options.config_path.empty() ? Config{} : load_config(options.config_path);
  if (!options.url.empty()) config.daemon.url = options.url;
  if (!options.out_url.empty()) config.daemon.out_url = options.out_url;
  if (!options.scan_channels.empty()) config.daemon.scan_channels = options.scan_channels;
  if (!options.pose_channel.empty()) config.daemon.pose_channel = options.pose_channel;
  if (!options.map_file.empty()) config.daemon.map.file = options.map_file;
  if (options.threads != 0) config.tracker.threads = options.threads;
  check_config(config);
  return config;
}

nlohmann::json to_json(const DoctorReport& report) {
  const char* const kGrades[] = {"ok", "note", "fault"};
  nlohmann::json json = {{"ok", report.good()},
                         {"url", report.url},
                         {"recv_buf_wanted", report.recv_buf_wanted},
                         {"recv_buf_granted", report.recv_buf_granted},
                         {"rmem_max", report.rmem_max},
                         {"echo", {{"sent", report.echoes_sent}, {"received", report.echoes_received}}},
                         {"kernel_drops", report.kernel_drops},
                         {"listened_s", report.listened_s},
                         {"findings", nlohmann::json::array()},
                         {"heard", nlohmann::json::array()}};
  for (const auto& finding : report.findings) {
    json["findings"].push_back({{"name", finding.name},
                                {"grade", kGrades[static_cast<int>(finding.grade)]},
                                {"detail", finding.detail},
                                {"remedy", finding.remedy}});
  }
  for (const auto& heard : report.heard) {
    json["heard"].push_back({{"channel", heard.name},
                             {"type", heard.type},
                             {"messages", heard.messages},
                             {"largest_bytes", heard.largest_bytes}});
  }
  return json;
}

int check(const Config& config, bool json) {
  if (isatty(STDERR_FILENO) != 0)
    std::fprintf(stderr, "checking the host, and listening for three seconds ...\n");
  const DoctorReport report = examine(config.daemon);
  if (json) {
    print_json(to_json(report));
  } else {
    print(print_report(report));
  }
  return report.good() ? 0 : 1;
}

/// Checks the logs of input and output before the output is opened for writing.
void check_logs(const Options& options, const DaemonConfig& daemon) {
  const std::string input = log_url_path(input_url(daemon)), url = output_url(daemon);
  if (!input.empty()) check_log(input);
  const std::string mode = url_option(url, "mode").value_or("r");
  if (mode == "r") return;           // the daemon refuses it
  const bool appends = mode == "a";  // overwrites nothing
  const std::string& map = daemon.map.file;
  if (!map.empty() && is_log_url(url) && !std::filesystem::exists(map) &&
      same_file(destination_of(map), destination_of(log_url_path(url))))
    throw std::runtime_error(map + " and " + url + ": two outputs, but one file");
  check_outputs({{options.config_path, input, daemon.map.file}, {log_url_path(url)}, ""},
                options.force || appends);
}

int serve(const Config& config) {
  // A TCP peer that disconnected then fails one publish and does not end the daemon.
  signal(SIGPIPE, SIG_IGN);
  StopSignal stop;
  const SignalThread signals(stop, !saved_map_file(config.daemon.map).empty());
  std::string channels;
  for (const auto& channel : config.daemon.scan_channels) channels += " " + channel;
  log_line(LogLevel::kInfo, std::string("version ") + SCANLOCK_VERSION + ": scans from" + channels + " at " +
                                input_url(config.daemon) + ", poses on " + config.daemon.pose_channel +
                                " at " + output_url(config.daemon));
  Daemon daemon(config, SCANLOCK_VERSION);
  daemon.run(stop);
  const Counters counters = daemon.report().counters;
  log_line(LogLevel::kInfo, "ended: " + std::to_string(counters.received) + " scans received, " +
                                std::to_string(counters.used) + " used, " +
                                std::to_string(counters.replaced) + " replaced by newer ones, " +
                                std::to_string(counters.rejected()) + " rejected, " +
                                std::to_string(counters.without_time) + " without a time, " +
                                std::to_string(counters.kernel_drops) + " datagrams dropped by the kernel");
  if (counters.priors_rejected + counters.priors_absent + counters.priors_contradicting > 0) {
    log_line(LogLevel::kInfo, "priors: " + std::to_string(counters.priors_rejected) + " messages rejected, " +
                                  std::to_string(counters.priors_absent) + " scans without a prior, " +
                                  std::to_string(counters.priors_contradicting) +
                                  " scans that contradict their prior");
  }
  return 0;
}

void declare(CommandLine line, Options& options) {
  line.explain(
      "", {"scanlockd --check", "scanlockd --scan-channel LIDAR --map yard.map", "scanlockd -c robot.toml",
           "scanlockd -l 'file://drive.lcmlog?speed=0' --out-url 'file://poses.lcmlog?mode=w'"});
  line.option("-c,--config", options.config_path, "configuration (TOML); --print-config shows all keys");
  line.option("-l,--lcm-url", options.url,
              "LCM URL of the scans; default: LCM_DEFAULT_URL, else " + std::string(kDefaultUrl));
  line.option("--out-url", options.out_url, "LCM URL of the published messages; default: that of the scans");
  line.option("--scan-channel", options.scan_channels,
              "channel that carries scans, may be repeated; default: LIDAR")
      .repeated();
  line.option("--pose-channel", options.pose_channel,
              "channel of bot_core.pose_t; default: POSE_BODY_CORRECTED");
  line.option(
      "--map", options.map_file,
      "map to relocalise in, and to save to on exit (.map); or a cloud from any program (.ply, .pcd), "
      "which is never written; see map.mode. Default: none");
  line.option("--threads", options.threads, "threads of one alignment; the result does not depend on it")
      .within(1, 256);
  line.flag("--check", options.check,
            "the doctor: test whether scans arrive on this host, and print the command that corrects each "
            "fault; exit 1 if scans would be lost");
  line.flag("--print-config", options.print,
            "print the configuration in effect, each key with its explanation, and exit");
  line.flag("--json", options.json, "with --check: one JSON object on standard output");
  line.flag("--force", options.force, "overwrite the log that --out-url names, where it is there already");
}

int run(const Options& options) {
  if (options.json && !options.check) throw UsageError("--json needs --check");
  const Config config = configured(options);
  if (options.print) {
    print(print_config(config));
    return 0;
  }
  if (options.check) return check(config, options.json);
  check_logs(options, config.daemon);
  return serve(config);
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<Options>("scanlockd", "LiDAR odometry on LCM: scans in, poses out.", argc, argv, declare,
                              run);
}
