#include "procman/deputy/orders.hpp"

#include <cmath>

namespace curbstone::procman::deputy {

namespace {
constexpr std::size_t kMaxId = 200;      // bytes
constexpr std::size_t kMaxExec = 16384;  // bytes
}  // namespace

OrderStep decide(bool running, std::int32_t actual_runid, std::int32_t desired_runid, bool force_quit) {
  const bool other_run = actual_runid != desired_runid;
  if (!running && other_run && !force_quit) return OrderStep::kStart;
  if (running && (force_quit || (other_run && desired_runid != 0))) return OrderStep::kStop;
  return desired_runid != 0 ? OrderStep::kTakeRunId : OrderStep::kNothing;
}

std::optional<config::Command> command_from_wire(const procman_lcm::cmd_t& wire, const std::string& deputy) {
  if (wire.command_id.empty() || wire.command_id.size() > kMaxId || wire.exec_str.empty() ||
      wire.exec_str.size() > kMaxExec) {
    return std::nullopt;
  }
  config::Command command;
  command.id = wire.command_id;
  command.exec = wire.exec_str;
  command.deputy = deputy;
  command.group = wire.group;
  command.auto_respawn = wire.auto_respawn != 0;
  if (wire.stop_signal >= 1 && wire.stop_signal <= 64) command.stop_signal = wire.stop_signal;
  if (std::isfinite(wire.stop_time_allowed) && wire.stop_time_allowed >= 0) {
    command.stop_time_allowed = std::min(static_cast<double>(wire.stop_time_allowed), 86400.0);
  }
  return command;
}

procman_lcm::cmd_t command_to_wire(const config::Command& command) {
  procman_lcm::cmd_t wire;
  wire.command_id = command.id;
  wire.exec_str = command.exec;
  wire.group = command.group;
  wire.auto_respawn = command.auto_respawn ? 1 : 0;
  wire.stop_signal = static_cast<std::int8_t>(command.stop_signal);
  wire.stop_time_allowed = static_cast<float>(command.stop_time_allowed);
  return wire;
}

}  // namespace curbstone::procman::deputy
