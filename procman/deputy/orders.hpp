#pragma once

#include <cstdint>
#include <optional>
#include <procman_lcm/cmd_desired_t.hpp>
#include <procman_lcm/cmd_t.hpp>
#include <string>

#include "procman/config/config.hpp"

namespace curbstone::procman::deputy {

/// The step that an order requires of a command in its present state. A run id identifies a run of the command: a
/// sheriff that wants a restart increments it, and the deputy acts if its own number differs. So an order can be lost
/// or repeated without harm.
enum class OrderStep {
  kNothing,
  kStart,     ///< start it and take over the run id
  kStop,      ///< (begin to) stop it; a restart needs a later order, after it has ended
  kTakeRunId  ///< take over the run id only
};
[[nodiscard]] OrderStep decide(bool running, std::int32_t actual_runid, std::int32_t desired_runid, bool force_quit);

/// Orders older than this are ignored.
inline constexpr std::int64_t kStaleAfter = 60'000'000;  // us

/// A received command. Values out of range are replaced by the defaults. Nothing if its id or exec is invalid.
[[nodiscard]] std::optional<config::Command> command_from_wire(const procman_lcm::cmd_t& wire,
                                                               const std::string& deputy);
[[nodiscard]] procman_lcm::cmd_t command_to_wire(const config::Command& command);

}  // namespace curbstone::procman::deputy
