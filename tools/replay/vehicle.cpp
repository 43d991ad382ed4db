#include "tools/replay/vehicle.hpp"

#include <cstdlib>

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

ReplayVehicle::ReplayVehicle(const ReplayOptions& options, LocalBus& bus) : bus_(bus) {
  auto semantic = config_of<semantic_map::SemanticMapConfig>("semantic_map", kProcessSections, options.config_file,
                                                             options.assignments);
  if (!options.map_file.empty()) semantic.map = options.map_file;
  semantic.keep_earlier_drives = false;  // the user says which file is to be made
  auto ekf = config_of<ekf::base::EkfConfig>("ekf", kProcessSections, options.config_file, options.assignments);
  ekf.state_file.clear();  // another vehicle's, or of another time
  stages_.push_back({"ekf", std::make_unique<ekf::EkfNode>(ekf, bus)});
  stages_.push_back({"mapper", std::make_unique<mapper::MapperNode>(
                                   config_of<mapper::config::MapperConfig>("mapper", kProcessSections,
                                                                           options.config_file, options.assignments),
                                   bus)});
  stages_.push_back(
      {"tensor_voting", std::make_unique<tensor_voting::worker::TensorVotingNode>(
                            config_of<tensor_voting::worker::TensorVotingConfig>(
                                "tensor_voting", kProcessSections, options.config_file, options.assignments),
                            "tensor_voting:1", bus)});
  stages_.push_back({"semantic_map", std::make_unique<semantic_map::SemanticMapNode>(semantic, bus)});
  for (Stage& stage : stages_) stage.node->connect(bus);
}

ReplayVehicle::~ReplayVehicle() = default;

void ReplayVehicle::advance(std::int64_t now) {
  if (last_tick_ == 0) last_tick_ = now;
  // A gap in the log is no reason to tick through it.
  if (std::abs(now - last_tick_) > 50 * kTickPeriod) last_tick_ = now - kTickPeriod;
  while (last_tick_ + kTickPeriod <= now) tick(last_tick_ += kTickPeriod);
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
