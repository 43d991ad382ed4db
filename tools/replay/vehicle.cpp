#include "tools/replay/vehicle.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>

#include "common/config/assignments.hpp"
#include "common/config/config.hpp"
#include "config/sections.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/semantic_map/semantic_map_config.hpp"
#include "services/semantic_map/semantic_map_node.hpp"
#include "services/tensor_voting/worker/tensor_voting_config.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"

namespace curbstone::replay {

namespace {

constexpr std::array<std::string_view, 4> kSections = {"ekf", "mapper", "tensor_voting", "semantic_map"};

/// One process's configuration, and its text.
template <class Config>
Config configured(const std::string& section, const ReplayOptions& options, std::string& text) {
  ConfigOf<Config> config;
  const auto recorded = options.recorded.sections.find(section);
  if (!options.config_file.empty()) {
    load_config(options.config_file, section, kProcessSections, config);
  } else if (recorded != options.recorded.sections.end()) {
    try {
      parse_config(recorded->second, "the log's CONFIG", section, kProcessSections, config);
    } catch (const ConfigError& error) {
      throw ConfigError(fmt::format("{}: it was recorded by version {}; --config FILE goes without it", error.what(),
                                    options.recorded.version));
    }
  }
  for (const std::string& assignment : options.assignments) {
    if (assignment.starts_with(section + ".")) set_config_value(assignment.substr(section.size() + 1), config);
  }
  text = dump_config(section, config);
  return config.value;
}

}  // namespace

std::vector<Stage> make_stages(const ReplayOptions& given,
                               const std::function<Publisher&(const std::string& name)>& bus_of) {
  ReplayOptions options = given;
  options.assignments = assignments_for(kSections, given.assignments);
  std::string semantic_text;
  auto semantic = configured<semantic_map::SemanticMapConfig>("semantic_map", options, semantic_text);
  if (!options.map_file.empty()) semantic.map = options.map_file;
  semantic.keep_earlier_drives = false;  // the user says which file is to be made
  if (options.config_file.empty() && options.recorded.sections.contains("semantic_map")) semantic.picture.clear();
  std::string ekf_text;
  auto ekf = configured<ekf::base::EkfConfig>("ekf", options, ekf_text);
  ekf.state_file.clear();  // another vehicle's, or of another time
  std::string mapper_text;
  auto mapper = configured<mapper::config::MapperConfig>("mapper", options, mapper_text);
  mapper.journal.clear();  // likewise
  std::string voting_text;
  const auto voting = configured<tensor_voting::worker::TensorVotingConfig>("tensor_voting", options, voting_text);
  using tensor_voting::worker::TensorVotingNode;
  std::vector<Stage> stages;
  stages.push_back({"ekf", ekf_text, std::make_unique<ekf::EkfNode>(ekf, bus_of("ekf"))});
  stages.push_back({"mapper", mapper_text, std::make_unique<mapper::MapperNode>(mapper, bus_of("mapper"))});
  stages.push_back({"tensor_voting", voting_text,
                    std::make_unique<TensorVotingNode>(voting, "tensor_voting:1", bus_of("tensor_voting"))});
  stages.push_back({"semantic_map", semantic_text,
                    std::make_unique<semantic_map::SemanticMapNode>(semantic, bus_of("semantic_map"))});
  return stages;
}

ReplayVehicle::ReplayVehicle(const ReplayOptions& options, LocalBus& bus)
    : bus_(bus),
      tick_period_(options.tick_period),
      stages_(make_stages(options, [&](const std::string&) -> Publisher& { return bus; })) {
  for (Stage& stage : stages_) stage.node->connect(bus);
}

ReplayVehicle::~ReplayVehicle() = default;

void ReplayVehicle::advance(std::int64_t now) {
  if (last_tick_ == 0) last_tick_ = now;
  // A gap in the log is no reason to tick through it.
  if (std::abs(now - last_tick_) > 50 * tick_period_) last_tick_ = now - tick_period_;
  while (last_tick_ + tick_period_ <= now) tick(last_tick_ += tick_period_);
}

void ReplayVehicle::tick(std::int64_t now) {
  for (Stage& stage : stages_) {
    stage.node->tick(now);
    bus_.dispatch();
  }
}

void ReplayVehicle::finish() {
  for (Stage& stage : stages_) {
    stage.node->finish();
    bus_.dispatch();
  }
}

}  // namespace curbstone::replay
