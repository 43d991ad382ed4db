#include "tools/recording/recorded_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <set>

#include "common/bus/decode.hpp"

namespace curbstone::recording {

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

/// The vehicle of a recorded section, as the top of a file has it; empty if it has none.
std::string vehicle_in(const std::string& section, const std::string& yaml) {
  try {
    const YAML::Node root = YAML::Load(yaml);
    const YAML::Node own = root.IsMap() ? root[section] : YAML::Node();
    if (!own || !own.IsMap() || !own["vehicle"]) return {};
    YAML::Node top;
    top["vehicle"] = own["vehicle"];
    return YAML::Dump(top);
  } catch (const YAML::Exception&) {
    return {};  // a log may contain invalid YAML
  }
}

/// The vehicle of the mapper, else of the first section that has one; empty if none has.
std::string vehicle_yaml(const RecordedConfig& recorded) {
  const auto mapper = recorded.sections.find("mapper");
  std::string vehicle = mapper == recorded.sections.end() ? "" : vehicle_in("mapper", mapper->second);
  for (auto it = recorded.sections.begin(); vehicle.empty() && it != recorded.sections.end(); ++it)
    vehicle = vehicle_in(it->first, it->second);
  return vehicle;
}

/// A configuration with only the section `vehicle:`.
struct VehicleOnly {
  VehicleConfig vehicle;
  void visit(ConfigVisitor& v) { v.section("vehicle", vehicle, "shared: the vehicle"); }
};

}  // namespace

void RecordedConfig::add(const service_config_t& message) {
  if (version.empty()) version = message.version;
  sections.try_emplace(message.section, message.yaml);
}

VehicleConfig RecordedConfig::vehicle() const {
  ConfigOf<VehicleOnly> config;
  load("", config);  // no section of this name: the vehicle alone
  return config.value.vehicle;
}

void RecordedConfig::load(const std::string& section, AnyConfig& config) const {
  const auto own = sections.find(section);
  const std::string yaml = own != sections.end() ? own->second : vehicle_yaml(*this);
  if (yaml.empty()) return;
  try {
    parse_config(yaml, "the log's CONFIG", section, kProcessSections, config);
  } catch (const ConfigError& error) {
    throw ConfigError(
        fmt::format("{}: it was recorded by version {}; --config FILE goes without it", error.what(), version));
  }
}

VehicleConfig vehicle_of(const std::string& file, const RecordedConfig& recorded) {
  if (file.empty()) return recorded.vehicle();
  ConfigOf<VehicleOnly> config;
  load_config(file, "", kProcessSections, config);  // no section of this name: the vehicle alone
  return config.value.vehicle;
}

std::string source_of_configuration(const std::vector<std::string>& sections, const std::string& file,
                                    const RecordedConfig& recorded, const std::vector<std::string>& assignments) {
  std::vector<std::string> missing;
  for (const std::string& section : sections) {
    if (!recorded.sections.contains(section)) missing.push_back(section);
  }
  std::string source = file;
  if (file.empty()) {
    source = recorded.empty() ? "the defaults, as none is recorded" : "as recorded by " + recorded.version;
    if (!recorded.empty() && !missing.empty())
      source += fmt::format("; {}: {}the defaults, as none is recorded", fmt::join(missing, ", "),
                            vehicle_yaml(recorded).empty() ? "" : "the recorded vehicle, else ");
  }
  return assignments.empty() ? source : source + ", and --set";
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

}  // namespace curbstone::recording
