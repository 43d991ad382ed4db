#pragma once

#include <cstdint>
#include <optional>
#include <procman_lcm/cmd_desired_t.hpp>
#include <procman_lcm/cmd_t.hpp>
#include <string>

#include "procman/config/config.hpp"

namespace curbstone::procman::deputy {

/// What one order asks of one command in its present state. A run id says which run of the command is meant: a sheriff
/// that wants a restart counts it up, and the deputy acts if its own number differs. So an order can be lost or
/// repeated without harm.
enum class OrderStep {
  kNothing,
  kStart,     ///< start it, and take over the run id
  kStop,      ///< (begin to) stop it; a restart needs a later order, when it has ended
  kTakeRunId  ///< nothing to do, but remember the run id
};
[[nodiscard]] OrderStep decide(bool running, std::int32_t actual_runid, std::int32_t desired_runid, bool force_quit);

/// Orders older than this are ignored.
inline constexpr std::int64_t kStaleAfter = 60'000'000;  // us

/// A command as received. Values out of range are replaced by the defaults. Nothing if its id or exec cannot be used.
[[nodiscard]] std::optional<config::Command> command_from_wire(const procman_lcm::cmd_t& wire,
                                                               const std::string& deputy);
[[nodiscard]] procman_lcm::cmd_t command_to_wire(const config::Command& command);

}  // namespace curbstone::procman::deputy
