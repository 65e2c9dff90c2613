// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <signal.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "../contains.hpp"
#include "listener.hpp"
#include "network.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

long lines_in(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace

namespace {

/// Sends ten scans per second during its lifetime.
class Publisher {
 public:
  Publisher(const std::string& url, const std::string& channel) {
    thread_ = std::thread([this, url, channel] {
      Listener sender(url);
      for (int i = 0; !stop_; ++i) {
        sender.publish(channel, bytes_of(scan_from({}, utime_of(i), 16, 360)));
        std::this_thread::sleep_for(milliseconds(100));
      }
    });
  }
  ~Publisher() {
    stop_ = true;
    thread_.join();
  }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace

TEST_CASE("help and version go to standard output and are no errors") {
  const TemporaryFolder folder;
  const Result help = run(folder, {"scanlockd", "--help"});
  CHECK(help.code == 0);
  CHECK(contains(help.output, "--scan-channel"));
  const Result version = run(folder, {"scanlockd", "-V"});
  CHECK(version.code == 0);
  CHECK(contains(version.output, "."));
}

TEST_CASE("wrong usage exits with 2") {
  const TemporaryFolder folder;
  CHECK(run(folder, {"scanlockd", "--no-such-flag"}).code == 2);
  CHECK(run(folder, {"scanlockd", "--threads", "0"}).code == 2);
  CHECK(run(folder, {"scanlockd", "stray"}).code == 2);
}

TEST_CASE("an unusable configuration exits with 1 and one line that locates the error") {
  const TemporaryFolder folder;
  write_file(folder / "unknown.toml", "[tracker]\nthread = 2\n");
  write_file(folder / "range.toml", "[tracker]\nthreads = 0\n");
  write_file(folder / "broken.toml", "[tracker\n");
  const std::string missing = folder / "missing.toml";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"unknown.toml", "unknown.toml:2: tracker.thread: unknown key; did you mean tracker.threads?"},
      {"range.toml", "range.toml:2: tracker.threads: 0 is not in 1 to 256"},
      {"broken.toml", "broken.toml:1: not TOML"},
      {"missing.toml", missing}};
  for (const auto& [file, sentence] : cases) {
    const std::string name = file;  // clang++ 14 cannot capture a structured binding
    CAPTURE(name);
    const Result result = run(folder, {"scanlockd", "-c", folder / name});
    CHECK(result.code == 1);
    CHECK(contains(result.errors, sentence));
    CHECK(lines_in(result.errors) == 1);
    CHECK(result.output.empty());
  }
}

TEST_CASE("the printed configuration, read back, prints the same configuration") {
  const TemporaryFolder folder;
  const Result printed =
      run(folder, {"scanlockd", "--print-config", "--scan-channel", "A", "--threads", "3"});
  CHECK(printed.code == 0);
  write_file(folder / "same.toml", printed.output);
  const Result again = run(folder, {"scanlockd", "--print-config", "-c", folder / "same.toml"});
  CHECK(again.code == 0);
  CHECK(again.output == printed.output);
}

TEST_CASE("a log that cannot be read or written exits with 1 and is named") {
  const Network network;
  const TemporaryFolder folder;
  const Result missing = run(folder, {"scanlockd", "-l", "file://" + (folder / "no.lcmlog")});
  CHECK(missing.code == 1);
  CHECK(contains(missing.errors, "no.lcmlog"));
  const Result reading = run(folder, {"scanlockd", "--out-url", "file://" + (folder / "out.lcmlog")});
  CHECK(reading.code == 1);
  CHECK(contains(reading.errors, "mode=w"));
}

TEST_CASE("a signal ends a working daemon with exit code 0") {
  const Network network;
  if (!network.lack().empty()) {
    MESSAGE("skipped: " << network.lack());
    return;
  }
  const TemporaryFolder folder;
  std::vector<std::vector<std::uint8_t>> scans;
  for (int i = 0; i < 40; ++i) scans.push_back(bytes_of(scan_from(place_on_drive(i), utime_of(i), 16, 900)));
  for (const int signal : {SIGTERM, SIGINT}) {
    Listener listener(network.url());
    Process daemon(folder, {"scanlockd", "-l", network.url()});
    REQUIRE(listener.until_ready());
    for (const auto& scan : scans) {  // faster than any tracker
      listener.publish("LIDAR", scan);
      std::this_thread::sleep_for(milliseconds(1));
    }
    daemon.send(signal);
    CHECK(daemon.wait(seconds(2)) == 0);  // the daemon promises one second; the machine may be busy
    CHECK(contains(daemon.errors(), "ended: "));
  }
}

TEST_CASE("without a multicast route the daemon waits with instructions, and works once the route exists") {
  Network network(false);
  if (!network.is_private()) {
    MESSAGE("skipped: no network namespace of its own");
    return;
  }
  const TemporaryFolder folder;
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  while (!contains(daemon.errors(), "cannot receive") && !daemon.wait(milliseconds(50))) {
  }
  CHECK(contains(daemon.errors(), "ip link set lo up"));
  const Result command = run(folder, {"scanlock-command", "-l", network.url(), "reset"});
  CHECK(command.code == 1);
  CHECK(contains(command.errors, "nothing can be received; see scanlockd --check"));
  CHECK_FALSE(daemon.wait(milliseconds(500)).has_value());
  network.add_route();
  Listener listener(network.url());
  REQUIRE(listener.until_ready());
  const auto scan = bytes_of(scan_from({}, utime_of(0), 16, 360));
  CHECK(listener.until(
      [&] {
        listener.publish("LIDAR", scan);
        return !listener.poses.empty();
      },
      seconds(15)));
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(2)) == 0);
}

TEST_CASE(
    "multicast dropped by a firewall is reported, and the daemon works once the firewall lets it pass") {
  const TemporaryFolder folder;
  const Network network;
  const std::string port = network.url().substr(network.url().rfind(':') + 1, 5);
  const auto firewall = [&](const char* action) {
    return run(folder, {"iptables", "-w", action, "INPUT", "-p", "udp", "--dport", port, "-j", "DROP"}).code;
  };
  if (!network.is_private() || firewall("-A") != 0) {
    MESSAGE("skipped: no network namespace with iptables");
    return;
  }
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  Process check(folder, {"scanlockd", "--check", "-l", network.url()});
  Process command(folder, {"scanlock-command", "-l", network.url(), "reset"});
  CHECK(check.wait(seconds(30)) == 1);
  CHECK(contains(check.output(), "a firewall may drop UDP port " + port));
  CHECK(command.wait(seconds(30)) == 1);
  CHECK(contains(command.errors(), "see scanlockd --check"));
  const auto end = std::chrono::steady_clock::now() + seconds(30);
  while (!contains(daemon.errors(), "a firewall may drop UDP port " + port)) {
    REQUIRE(std::chrono::steady_clock::now() < end);
    std::this_thread::sleep_for(milliseconds(50));
  }
  REQUIRE(firewall("-D") == 0);
  Listener listener(network.url());
  CHECK(listener.until([&] { return listener.statuses > 0 && listener.status.recv_buf_granted > 0; },
                       seconds(30)));
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(15)) == 0);
}

TEST_CASE("a signal ends a daemon that still waits for its network") {
  Network network(false);
  if (!network.is_private()) {
    MESSAGE("skipped: no network namespace of its own");
    return;
  }
  const TemporaryFolder folder;
  Process daemon(folder, {"scanlockd", "-l", network.url()});
  while (!contains(daemon.errors(), "cannot receive") && !daemon.wait(milliseconds(50))) {
  }
  daemon.send(SIGTERM);
  CHECK(daemon.wait(seconds(2)) == 0);
}

TEST_CASE("scanlockd --check passes where multicast works") {
  const Network network;
  if (!network.lack().empty() || possible_receive_buffer() < 4000000) {
    MESSAGE("skipped: " << network.lack() << " (or no receive buffer of 4 MB)");
    return;
  }
  const TemporaryFolder folder;
  const Publisher publisher(network.url(), "LIDAR");
  const Result result = run(folder, {"scanlockd", "--check", "--json", "-l", network.url()});
  INFO(result.output);
  CHECK(result.code == 0);
  const auto json = nlohmann::json::parse(result.output);
  CHECK(json["ok"] == true);
  CHECK(json["echo"]["received"] == json["echo"]["sent"]);
}

TEST_CASE("scanlockd --check fails without scans, and names the channel that carries scans") {
  const Network network;
  if (!network.lack().empty() || possible_receive_buffer() < 4000000) {
    MESSAGE("skipped: " << network.lack() << " (or no receive buffer of 4 MB)");
    return;
  }
  const TemporaryFolder folder;
  const Result silent = run(folder, {"scanlockd", "--check", "-l", network.url()});
  CHECK(silent.code == 1);
  CHECK(contains(silent.output, "nothing came on LIDAR"));
  const Publisher publisher(network.url(), "VELODYNE");
  const Result elsewhere = run(folder, {"scanlockd", "--check", "-l", network.url()});
  CHECK(elsewhere.code == 1);
  CHECK(contains(elsewhere.output, "scans are on VELODYNE (bot_core.pointcloud2_t)"));
  CHECK(contains(elsewhere.output, "--scan-channel 'VELODYNE'"));
}

TEST_CASE("scanlockd --check reads a log as the replay does") {
  const TemporaryFolder folder;
  const std::string log = folder / "drive.lcmlog", other = folder / "notes.txt";
  write_log(log, drive(4, 16, 360));
  write_file(other, "notes");
  const auto check = [&](const std::string& path, const std::string& channel) {
    return run(folder, {"scanlockd", "--check", "-l", "file://" + path, "--scan-channel", channel});
  };
  const Result good = check(log, "LIDAR");
  CHECK(good.code == 0);
  CHECK(contains(good.output, "LIDAR carries bot_core.pointcloud2_t"));
  const Result misspelt = check(log + "?sped=0", "LIDAR");
  CHECK(misspelt.code == 1);
  CHECK(contains(misspelt.errors, "did you mean speed?"));
  const Result elsewhere = check(log, "VELODYNE");
  CHECK(elsewhere.code == 1);
  CHECK(contains(elsewhere.output, "scans are on LIDAR (bot_core.pointcloud2_t)"));
  CHECK(contains(elsewhere.output, "--scan-channel 'LIDAR'"));
  for (const std::string& path : {folder / "", std::string("/dev/null"), other, folder / "none"}) {
    CAPTURE(path);
    const Result result = check(path, "LIDAR");
    CHECK(result.code == 1);
    CHECK(contains(result.output, "FAULT " + path + ": "));
  }
}

TEST_CASE("a URL that can never work ends the program at once") {
  const TemporaryFolder folder;
  for (const char* url : {"udpm://239.255.76.67:99999", "udpm://10.0.0.1:7667", "lcm", "rtps://here"}) {
    CAPTURE(url);
    for (const char* flag : {"--force", "--check"}) {
      const Result result = run(folder, {"scanlockd", flag, "-l", url});
      CHECK(result.code == 1);
      CHECK(result.output.empty());
      CHECK(contains(result.errors, url));
    }
  }
}

TEST_CASE("scanlockd --check finds the faults and names the command for each") {
  Network network(false);
  if (!network.is_private()) {
    MESSAGE("skipped: no network namespace of its own");
    return;
  }
  const TemporaryFolder folder;
  const Result no_route = run(folder, {"scanlockd", "--check", "-l", network.url()});
  CHECK(no_route.code == 1);
  CHECK(contains(no_route.output, "ip link set lo up"));
  CHECK(contains(no_route.output, "ip route add 224.0.0.0/4 dev lo"));
  network.add_route();
  const Result small = run(folder, {"scanlockd", "--check", "-l", network.url() + "&recv_buf_size=100000"});
  CHECK(small.code == 1);
  CHECK(contains(small.output, "100000 bytes wanted, 100000 granted"));
  CHECK(contains(small.output, "recv_buf_size=8388608"));
}
