// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-command: sends a command to a running daemon, and waits for the status with its result.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <scanlock/command_t.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "daemon/lcm_self_test.hpp"
#include "daemon/lcm_url.hpp"
#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"
#include "messages/decode_report.hpp"

namespace {

using namespace scanlock;
using Clock = std::chrono::steady_clock;

struct Options {
  std::string url, channel = DaemonConfig().command_channel, status_channel = DaemonConfig().status_channel;
  std::vector<std::string> words;
  double timeout_s = 30;
};

constexpr const char* kFooter = R"(Commands:
  save FILE                   the daemon writes its map to FILE
  load FILE                   the daemon discards its map, and relocalises in the map FILE
  reset                       the daemon discards its map; the next scan starts a new one
  set-pose X Y Z YAW_DEG      sets the pose of the body in the map: metres and degrees

FILE is a file of the machine that the daemon runs on. Exit 0: done; 1: rejected, with the daemon's reason, or no answer.)";

double number(const std::string& word) {
  const std::optional<double> value = finite_number(word);
  if (!value) throw UsageError(word + ": not a number");
  return *value;
}

command_t command_of(const std::vector<std::string>& words) {
  command_t command{};
  command.utime = std::chrono::duration_cast<std::chrono::microseconds>(
                      std::chrono::system_clock::now().time_since_epoch())
                      .count();
  const std::string& kind = words.front();
  const std::size_t arguments = words.size() - 1;
  const auto expect = [&](std::size_t count, const char* what) {
    if (arguments != count) throw UsageError(kind + " takes " + what);
  };
  if (kind == "save" || kind == "load") {
    expect(1, "a file");
    command.command = kind == "save" ? command_t::SAVE_MAP : command_t::LOAD_MAP;
    // The daemon's working directory may be another one.
    command.path = std::filesystem::absolute(words[1]).string();
  } else if (kind == "reset") {
    expect(0, "no argument");
    command.command = command_t::RESET;
  } else if (kind == "set-pose") {
    expect(4, "X Y Z in metres and YAW_DEG");
    command.command = command_t::SET_POSE;
    for (std::size_t i = 0; i < 3; ++i) command.pos[i] = number(words[i + 1]);
    const Eigen::Quaterniond turn(rotation_about_z(number(words[4]) * kDegree));
    command.quat[0] = turn.w();
    command.quat[3] = turn.z();
  } else {
    throw UsageError(kind + ": unknown command");
  }
  return command;
}

/// Receives the status messages of the daemon.
class StatusListener {
 public:
  StatusListener(lcm::LCM& lcm, const std::string& channel) : lcm_(lcm) {
    lcm.subscribe(literal_pattern(channel), &StatusListener::take, this);
  }

  /// The next status; nothing where none arrives before `until`.
  std::optional<StatusReport> next(Clock::time_point until) {
    last_.reset();
    while (!last_ && Clock::now() < until) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
      if (lcm_.handleTimeout(static_cast<int>(std::clamp<std::int64_t>(left, 1, 1000))) < 0)
        throw std::runtime_error("LCM failed while waiting for a status message");
    }
    return last_;
  }

 private:
  void take(const lcm::ReceiveBuffer* buffer, const std::string&) {
    auto decoded = decode_status(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (decoded.ok()) last_ = std::move(decoded.value);
  }

  lcm::LCM& lcm_;
  std::optional<StatusReport> last_;
};

/// The result of a command in words.
std::string done(const command_t& command) {
  switch (command.command) {
    case command_t::SAVE_MAP:
      return command.path + ": the map is saved";
    case command_t::LOAD_MAP:
      return command.path + ": the map is loaded; the daemon relocalises in it";
    case command_t::RESET:
      return "the map is discarded; the next scan starts a new one";
    default:
      return "the pose is set";
  }
}

int run(const Options& options) {
  const command_t command = command_of(options.words);
  DaemonConfig config;
  config.url = options.url;
  const std::string url = input_url(config);
  if (is_log_url(url))
    throw std::runtime_error(url + ": commands cannot be sent to a log; name the URL of a running daemon");
  check_url(url);
  lcm::LCM lcm(url);
  if (!lcm.good() || !passes_self_test(lcm, url))
    throw std::runtime_error(url + ": nothing can be received; see scanlockd --check");
  StatusListener listener(lcm, options.status_channel);
  const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(options.timeout_s));
  const std::optional<StatusReport> before = listener.next(until);
  if (!before)
    throw std::runtime_error("no status of a daemon on " + options.status_channel + " at " + url +
                             "; is scanlockd running there?");
  if (lcm.publish(options.channel, &command) != 0)
    throw std::runtime_error(url + ": the command cannot be sent");
  while (const std::optional<StatusReport> now = listener.next(until)) {
    if (now->commands > before->commands) {
      print(done(command) + "\n");
      return 0;
    }
    if (now->commands_rejected > before->commands_rejected) throw std::runtime_error(now->last_error);
  }
  throw std::runtime_error("the daemon did not report the result of the command in time (--timeout)");
}

void declare(CommandLine line, Options& options) {
  line.explain(kFooter, {"scanlock-command save yard.map",
                         "scanlock-command -l 'udpm://239.255.76.67:7667?ttl=1' set-pose 12.5 -3 0 90"});
  line.option("COMMAND", options.words, "save, load, reset or set-pose, and its arguments").required();
  line.option("-l,--lcm-url", options.url, "LCM URL (default: LCM_DEFAULT_URL, else this host's multicast)");
  line.option("--channel", options.channel, "channel of the commands (default: SCANLOCK_COMMAND)").channel();
  line.option("--status-channel", options.status_channel, "channel of the status (default: SCANLOCK_STATUS)")
      .channel();
  line.option("--timeout", options.timeout_s, "seconds to wait for the result (default: 30)").above_zero();
}

}  // namespace

int main(int argc, char** argv) {
  return run_program<Options>("scanlock-command", "Sends a command to a running scanlockd.", argc, argv,
                              declare, run);
}
