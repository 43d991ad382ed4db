#include "tools/bench/latency/timed_vehicle.hpp"

#include <algorithm>

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

namespace curbstone::bench::latency {

TimedVehicle::TimedVehicle(const TimedVehicleOptions& options, Listener listener)
    : listener_(std::move(listener)), cores_(static_cast<std::size_t>(options.cores)) {
  std::int64_t phase = 0;
  const auto add = [&](const std::string& name, auto make) {
    phase += 7'000;  // us; staggers the timers of the processes
    auto process = std::make_unique<TimedProcess>(phase % 20'000, [this](const TimedMessage& m) { send(m); });
    process->run(make(*process));
    processes_.emplace_back(name, std::move(process));
  };
  auto semantic = config_of<semantic_map::SemanticMapConfig>("semantic_map", kProcessSections, options.config_file,
                                                             options.assignments);
  semantic.map = options.map_file;
  auto ekf = config_of<ekf::base::EkfConfig>("ekf", kProcessSections, options.config_file, options.assignments);
  ekf.state_file.clear();
  add("ekf", [&](Publisher& bus) { return std::make_unique<ekf::EkfNode>(ekf, bus); });
  auto mapper =
      config_of<mapper::config::MapperConfig>("mapper", kProcessSections, options.config_file, options.assignments);
  mapper.journal.clear();
  mapper.threads = 1;  // other threads are not on this process's clock
  add("mapper", [&](Publisher& bus) { return std::make_unique<mapper::MapperNode>(mapper, bus); });
  add("tensor_voting", [&](Publisher& bus) {
    return std::make_unique<tensor_voting::worker::TensorVotingNode>(
        config_of<tensor_voting::worker::TensorVotingConfig>("tensor_voting", kProcessSections, options.config_file,
                                                             options.assignments),
        "tensor_voting:1", bus);
  });
  add("semantic_map", [&](Publisher& bus) { return std::make_unique<semantic_map::SemanticMapNode>(semantic, bus); });
}

void TimedVehicle::send(const TimedMessage& message) {
  listener_(message);
  for (const auto& [name, process] : processes_) process->deliver(message);
}

/// The process with the earliest start works first, so no message is sent before work that is already done.
void TimedVehicle::advance(std::int64_t to) {
  while (true) {
    const auto first = std::min_element(processes_.begin(), processes_.end(), [](const auto& a, const auto& b) {
      return a.second->next() < b.second->next();
    });
    const auto core = std::min_element(cores_.begin(), cores_.end());
    const std::int64_t begin = std::max(first->second->next(), *core);
    if (begin >= to) return;
    *core = first->second->work(begin);
  }
}

void TimedVehicle::sense(const LogEvent& event) {
  if (now_ == 0) {
    for (const auto& [name, process] : processes_) process->start(event.log_utime);
  }
  now_ = event.log_utime;
  advance(now_);
  send({now_, event.channel, std::make_shared<std::vector<std::uint8_t>>(event.bytes)});
}

}  // namespace curbstone::bench::latency
