// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/config.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "daemon/config_keys.hpp"
#include "daemon/nearest_name.hpp"

namespace scanlock {
namespace {

std::string to_text(double value) {
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;  // shortest exact text
  return {buffer, end};
}

std::string full_name(const ConfigKey& key) {
  return key.section + "." + key.name;
}

[[noreturn]] void fail(const std::string& where, const std::string& key, const std::string& what) {
  throw ConfigError((where.empty() ? "" : where + ": ") + key + ": " + what);
}

std::string range_text(const ConfigKey& key) {
  return to_text(key.min) + " to " + to_text(key.max) + (key.unit.empty() ? "" : " " + key.unit);
}

// ---- checks: one overload for each type of value ------------------------------------------------------

bool in_range(const ConfigKey& key, double value) {
  return value >= key.min && value <= key.max;
}  // false for NaN

void check_value(const ConfigKey&, bool, const std::string&) {}

void check_value(const ConfigKey& key, double value, const std::string& where) {
  if (!in_range(key, value)) fail(where, full_name(key), to_text(value) + " is not in " + range_text(key));
}

void check_value(const ConfigKey& key, int value, const std::string& where) {
  check_value(key, static_cast<double>(value), where);
}

void check_value(const ConfigKey& key, const std::string& value, const std::string& where) {
  const auto& choices = key.choices;
  if (!choices.empty() && std::find(choices.begin(), choices.end(), value) == choices.end()) {
    std::string list;
    for (const auto& choice : choices) list += (list.empty() ? "" : ", ") + choice;
    fail(where, full_name(key), "\"" + value + "\" is none of " + list);
  }
  if (!in_range(key, static_cast<double>(value.size()))) {
    fail(where, full_name(key),
         "has " + std::to_string(value.size()) + " characters; up to " + to_text(key.max) + " are possible");
  }
  if (value.find('\0') != std::string::npos) fail(where, full_name(key), "holds a zero byte");
}

void check_value(const ConfigKey& key, const std::vector<std::string>& values, const std::string& where) {
  if (!in_range(key, static_cast<double>(values.size()))) {
    fail(where, full_name(key),
         "has " + std::to_string(values.size()) + " entries; " + range_text(key) + " are possible");
  }
  for (const auto& value : values) {  // every list is a list of channels
    if (value.empty() || value.size() > 63)
      fail(where, full_name(key), "\"" + value + "\" is not a channel name: it needs 1 to 63 characters");
    if (std::count(values.begin(), values.end(), value) > 1)
      fail(where, full_name(key), "\"" + value + "\" is there twice");
  }
}

// ---- reading --------------------------------------------------------------------------------------------

void read_value(const toml::node& node, const ConfigKey& key, const std::string& where, bool& out) {
  if (!node.is_boolean()) fail(where, full_name(key), "expects true or false");
  out = node.as_boolean()->get();
}

void read_value(const toml::node& node, const ConfigKey& key, const std::string& where, int& out) {
  if (!node.is_integer()) fail(where, full_name(key), "expects a whole number in " + range_text(key));
  const std::int64_t value = node.as_integer()->get();
  if (!in_range(key, static_cast<double>(value))) {
    fail(where, full_name(key), std::to_string(value) + " is not in " + range_text(key));
  }
  out = static_cast<int>(value);
}

void read_value(const toml::node& node, const ConfigKey& key, const std::string& where, double& out) {
  if (node.is_integer()) {
    out = static_cast<double>(node.as_integer()->get());
  } else if (node.is_floating_point()) {
    out = node.as_floating_point()->get();
  } else {
    fail(where, full_name(key), "expects a number in " + range_text(key));
  }
}

void read_value(const toml::node& node, const ConfigKey& key, const std::string& where, std::string& out) {
  if (!node.is_string()) fail(where, full_name(key), "expects text in quotes");
  out = node.as_string()->get();
}

void read_value(const toml::node& node, const ConfigKey& key, const std::string& where,
                std::vector<std::string>& out) {
  const toml::array* array = node.as_array();
  if (array == nullptr) fail(where, full_name(key), "expects a list of texts, as [\"LIDAR\"]");
  out.clear();
  for (const auto& element : *array) {
    if (!element.is_string()) fail(where, full_name(key), "expects a list of texts, as [\"LIDAR\"]");
    out.push_back(element.as_string()->get());
  }
}

[[noreturn]] void fail_unknown(const std::string& where, const std::string& name) {
  std::vector<std::string> known, tables;
  std::string nearest;
  for (const auto& key : config_keys()) {
    known.push_back(full_name(key));
    tables.push_back(key.section);
    if (key.name == name) nearest = name + " in the table [" + key.section + "]";  // outside of its table
  }
  if (nearest.empty()) nearest = nearest_name(name, known);
  if (nearest.empty()) {
    const std::string table = nearest_name(name, tables);
    if (!table.empty()) nearest = "[" + table + "]";
  }
  fail(where, name,
       "unknown key; " + (nearest.empty() ? "scanlockd --print-config lists all of them"
                                          : "did you mean " + nearest + "?"));
}

std::string place(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line);
}

void read_section(const toml::table& table, const std::string& section, const std::string& file,
                  Config& config) {
  for (const auto& entry : table) {
    const std::string name(entry.first.str());
    const toml::node& node = entry.second;
    const std::string where = place(file, entry.first.source());
    const auto key = std::find_if(
        config_keys().begin(), config_keys().end(),
        [&](const ConfigKey& candidate) { return candidate.section == section && candidate.name == name; });
    if (key == config_keys().end()) fail_unknown(where, std::string(section).append(".").append(name));
    std::visit(
        [&](const auto& access) {
          auto& value = access(config);
          read_value(node, *key, where, value);
          check_value(*key, value, where);
        },
        key->access);
  }
}

Config read_document(const toml::table& document, const std::string& file) {
  Config config;
  for (const auto& [name, node] : document) {
    const std::string section(name.str());
    const bool known = std::any_of(config_keys().begin(), config_keys().end(),
                                   [&](const ConfigKey& key) { return key.section == section; });
    const toml::table* table = node.as_table();
    if (!known || table == nullptr) fail_unknown(place(file, name.source()), section);
    read_section(*table, section, file, config);
  }
  return config;
}

// ---- printing -------------------------------------------------------------------------------------------

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += escape;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string toml_text(bool value) {
  return value ? "true" : "false";
}
std::string toml_text(int value) {
  return std::to_string(value);
}
std::string toml_text(double value) {
  const std::string text = to_text(value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}
std::string toml_text(const std::string& value) {
  return quoted(value);
}
std::string toml_text(const std::vector<std::string>& values) {
  std::string out = "[";
  for (const auto& value : values) out += (out.size() > 1 ? ", " : "") + quoted(value);
  return out + "]";
}

std::string print_key(const ConfigKey& key, Config& config, Config& defaults) {
  return std::visit(
      [&](const auto& access) {
        using Value = std::decay_t<decltype(access(config))>;
        std::string out = "# " + key.help + "\n# ";
        if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>)
          out += range_text(key) + "; ";
        return out + "default " + toml_text(access(defaults)) + "\n" + key.name + " = " +
               toml_text(access(config)) + "\n";
      },
      key.access);
}

}  // namespace

Pose body_from_sensor(const MountConfig& mount) {
  constexpr double kRadiansPerDegree = 0.017453292519943295;
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(mount.x_m, mount.y_m, mount.z_m);
  pose.linear() = yaw_pitch_roll(mount.yaw_deg * kRadiansPerDegree, mount.pitch_deg * kRadiansPerDegree,
                                 mount.roll_deg * kRadiansPerDegree);
  return pose;
}

std::string scan_channel_names(const DaemonConfig& config) {
  std::string names;
  for (const std::string& channel : config.scan_channels) names += (names.empty() ? "" : ", ") + channel;
  return names;
}

Config parse_config(const std::string& text, const std::string& name) {
  try {
    return read_document(toml::parse(text, name), name);
  } catch (const toml::parse_error& error) {
    throw ConfigError(place(name, error.source()) + ": not TOML: " + std::string(error.description()));
  }
}

Config load_config(const std::string& path) {
  constexpr std::size_t kMaxBytes = 1 << 20;
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxBytes, '\0');
  if (file) file.read(text.data(), kMaxBytes);
  if (!file.is_open() || file.bad()) {
    throw ConfigError(path + ": cannot be read as a configuration: " + std::strerror(errno) +
                      "; name a readable TOML file, scanlockd --print-config writes one");
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() == kMaxBytes) throw ConfigError(path + ": over 1 MB: that is no configuration");
  return parse_config(text, path);
}

namespace {

/// A channel must not be configured for two purposes; in particular, no output may be an input.
void check_channels(const DaemonConfig& daemon) {
  std::vector<std::pair<std::string, std::string>> used;  // name, key
  for (const auto& channel : daemon.scan_channels) used.emplace_back(channel, "input.scan_channels");
  for (const auto& [channel, key] :
       {std::pair(daemon.pose_channel, "output.pose_channel"),
        std::pair(daemon.odometry_channel, "output.odometry_channel"),
        std::pair(daemon.status_channel, "output.status_channel"),
        std::pair(daemon.recovery_channel, "output.recovery_channel"),
        std::pair(daemon.local_pose_channel, "output.local_pose_channel"),
        std::pair(daemon.local_to_map_channel, "output.local_to_map_channel"),
        std::pair(daemon.rigid_transform_channel, "output.rigid_transform_channel"),
        std::pair(daemon.nav_odometry_channel, "output.nav_odometry_channel"),
        std::pair(daemon.pose2d_channel, "output.pose2d_channel"),
        std::pair(daemon.command_channel, "input.command_channel"),
        std::pair(daemon.attitude_channel, "input.attitude_channel"),
        std::pair(daemon.prior_odometry_channel, "input.prior_odometry_channel")}) {
    if (channel.empty()) continue;
    for (const auto& [other, other_key] : used) {
      if (channel == other)
        fail("", key, "\"" + channel + "\" is " + other_key + " already; give it a channel of its own");
    }
    used.emplace_back(channel, key);
  }
}

}  // namespace

void check_config(const Config& config) {
  check_channels(config.daemon);
  const TrackerConfig& tracker = config.tracker;
  for (const auto& [name, nearest] : {std::pair("tracker.min_range_m", tracker.min_range_m),
                                      std::pair("tracker.planar_min_range_m", tracker.planar_min_range_m)}) {
    if (!(nearest < tracker.max_range_m))
      fail("", name,
           to_text(nearest) + " m is not below tracker.max_range_m, " + to_text(tracker.max_range_m) +
               " m: no point of a scan would be left");
  }
  if (!(tracker.min_voxel_m <= tracker.max_voxel_m))
    fail("", "tracker.min_voxel_m",
         to_text(tracker.min_voxel_m) + " m is above tracker.max_voxel_m, " + to_text(tracker.max_voxel_m) +
             " m");
  Config copy = config;
  for (const auto& key : config_keys()) {
    std::visit([&](const auto& access) { check_value(key, access(copy), ""); }, key.access);
  }
}

std::string print_config(const Config& config) {
  Config copy = config, defaults;
  std::string out = "# Configuration of scanlockd and scanlock-odometry. Every key may be left out.\n";
  std::string section;
  for (const auto& key : config_keys()) {
    if (key.section != section) out += "\n[" + key.section + "]\n";
    section = key.section;
    out += print_key(key, copy, defaults);
  }
  return out;
}

}  // namespace scanlock
