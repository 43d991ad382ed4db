#include "tools/replay/vehicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "common/config/assignments.hpp"
#include "common/config/config.hpp"
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

constexpr std::int64_t kSettleStep = 1'000'000;  // us of message time by which settle() goes on
constexpr double kBandwidth = 10'000;  // MB/s: this bus loses nothing, and what is far is released once it is published

/// One process's configuration, and its section with all values as YAML.
template <class Config>
struct Section {
  Config value;
  std::string text;
};

template <class Config>
Section<Config> section_of(const std::string& section, const ReplayOptions& options) {
  auto config = recording::config_of<Config>(section, options.config_file, options.recorded, options.assignments);
  return {config.value, dump_config(section, config)};
}

struct Configuration {
  Section<ekf::base::EkfConfig> ekf;
  Section<mapper::config::MapperConfig> mapper;
  Section<tensor_voting::worker::TensorVotingConfig> voting;
  Section<semantic_map::SemanticMapConfig> semantic;
};

/// A dense map on disk is the vehicle's: a replay leaves it alone, unless the user names it.
void leave_folder_alone(const ReplayOptions& options, mapper::config::MapperConfig& mapper) {
  const bool is_named = std::any_of(options.assignments.begin(), options.assignments.end(),
                                    [](const std::string& a) { return a.starts_with("mapper.folder="); });
  if (is_named || mapper.folder.empty()) return;
  if (mapper.mode == mapper::config::MapMode::kExtend)
    throw ConfigError(
        fmt::format("mapper.folder: by mode extend this replay would add its drive to the map in {}: --set "
                    "mapper.folder=COPY takes a copy of what it was before the drive, --set mapper.mode=map makes a "
                    "map of its own",
                    mapper.folder));
  if (mapper.mode == mapper::config::MapMode::kMap) mapper.folder.clear();
}

/// What the processes had, but for what another vehicle, or another time, left on the disk.
Configuration configure(const ReplayOptions& given) {
  ReplayOptions options = given;
  options.assignments = assignments_for(kSections, given.assignments);
  Configuration all{section_of<ekf::base::EkfConfig>("ekf", options),
                    section_of<mapper::config::MapperConfig>("mapper", options),
                    section_of<tensor_voting::worker::TensorVotingConfig>("tensor_voting", options),
                    section_of<semantic_map::SemanticMapConfig>("semantic_map", options)};
  all.ekf.value.state_file.clear();
  all.mapper.value.journal.clear();
  all.voting.value.bandwidth = kBandwidth;
  leave_folder_alone(options, all.mapper.value);
  semantic_map::SemanticMapConfig& semantic = all.semantic.value;
  if (!options.map_file.empty()) semantic.map = options.map_file;
  semantic.keep_earlier_drives = options.keep_earlier_drives;
  if (options.config_file.empty() && options.recorded.sections.contains("semantic_map")) semantic.picture.clear();
  return all;
}

}  // namespace

bool Settling::goes_on(const std::vector<Stage>& stages, std::int64_t now) {
  std::size_t outstanding = 0;
  for (const Stage& stage : stages) outstanding += stage.node->num_outstanding();
  if (outstanding < least_) {
    least_ = outstanding;
    since_ = now;
  }
  return outstanding > 0 && now - since_ < kPatience;
}

void check_configuration(const ReplayOptions& options) {
  (void)configure(options);
}

std::vector<Stage> make_stages(const ReplayOptions& options,
                               const std::function<Publisher&(const std::string& name)>& bus_of) {
  const Configuration with = configure(options);
  using semantic_map::SemanticMapNode;
  using tensor_voting::worker::TensorVotingNode;
  std::vector<Stage> stages;
  stages.push_back({"ekf", with.ekf.text, std::make_unique<ekf::EkfNode>(with.ekf.value, bus_of("ekf"))});
  stages.push_back(
      {"mapper", with.mapper.text, std::make_unique<mapper::MapperNode>(with.mapper.value, bus_of("mapper"))});
  stages.push_back({"tensor_voting", with.voting.text,
                    std::make_unique<TensorVotingNode>(with.voting.value, "tensor_voting:1", bus_of("tensor_voting"))});
  stages.push_back({"semantic_map", with.semantic.text,
                    std::make_unique<SemanticMapNode>(with.semantic.value, bus_of("semantic_map"))});
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
  // Ticks are not made up across a gap in the log.
  if (std::abs(now - last_tick_) > 50 * tick_period_) last_tick_ = now - tick_period_;
  while (last_tick_ + tick_period_ <= now) tick(last_tick_ += tick_period_);
}

void ReplayVehicle::tick(std::int64_t now) {
  for (Stage& stage : stages_) {
    stage.node->tick(now);
    bus_.dispatch();
  }
}

void ReplayVehicle::end_drive() {
  settling_.emplace();
  for (Stage& stage : stages_) {
    stage.node->end_drive();
    bus_.dispatch();
  }
}

bool ReplayVehicle::settle() {
  if (last_tick_ == 0) return false;  // there was no drive
  if (!settling_) end_drive();
  for (const std::int64_t until = last_tick_ + kSettleStep; last_tick_ < until;) tick(last_tick_ += tick_period_);
  return settling_->goes_on(stages_, last_tick_);
}

void ReplayVehicle::finish() {
  while (settle()) {
  }
  for (Stage& stage : stages_) {
    stage.node->finish();
    bus_.dispatch();
  }
}

}  // namespace curbstone::replay
