#include "tools/replay/recorded_config.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <set>

#include "common/bus/decode.hpp"

namespace curbstone::replay {

namespace {

constexpr std::int64_t kSearched = 12'000'000;  // us of the drive

using Values = std::map<std::string, std::string>;

void flatten(const YAML::Node& node, const std::string& path, Values& values) {
  if (!node.IsMap()) {
    values[path] = YAML::Dump(node);
    return;
  }
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    flatten(entry.second, path.empty() ? key : path + "." + key, values);
  }
}

Values values_of(const std::string& yaml) {
  Values values;
  try {
    flatten(YAML::Load(yaml), "", values);
  } catch (const YAML::Exception&) {
    values.clear();  // a log may contain invalid YAML
  }
  return values;
}

const std::string& value_in(const Values& values, const std::string& key) {
  static const std::string kNone = "nothing";
  const auto it = values.find(key);
  return it == values.end() ? kNone : it->second;
}

bool set_by_replay(const std::string& key) {
  return key == "semantic_map.map" || key == "semantic_map.keep_earlier_drives" || key == "ekf.state_file" ||
         key == "mapper.journal" || key == "mapper.folder";
}

}  // namespace

void RecordedConfig::add(const service_config_t& message) {
  if (version.empty()) version = message.version;
  sections.try_emplace(message.section, message.yaml);
}

std::optional<service_config_t> config_in(const LogEvent& event) {
  service_config_t message;
  if (event.channel != "CONFIG" || !decode(event.bytes.data(), static_cast<int>(event.bytes.size()), message))
    return std::nullopt;
  return message;
}

RecordedConfig recorded_config(LogFiles& files) {
  RecordedConfig config;
  std::optional<std::int64_t> begin;
  while (const auto event = files.next()) {
    if (!begin) begin = event->log_utime;
    if (event->log_utime - *begin > kSearched) break;
    if (const auto message = config_in(*event)) config.add(*message);
  }
  return config;
}

std::vector<std::string> config_differences(const std::string& used, const std::string& recorded) {
  const Values ours = values_of(used);
  const Values theirs = values_of(recorded);
  std::set<std::string> keys;
  for (const Values* values : {&ours, &theirs}) {
    for (const auto& [key, value] : *values) keys.insert(key);
  }
  std::vector<std::string> differences;
  for (const std::string& key : keys) {
    const std::string& mine = value_in(ours, key);
    const std::string& other = value_in(theirs, key);
    if (mine != other && !set_by_replay(key))
      differences.push_back(fmt::format("{}: {}, recorded with {}", key, mine, other));
  }
  return differences;
}

}  // namespace curbstone::replay
