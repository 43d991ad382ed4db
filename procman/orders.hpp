#pragma once

#include <cstdint>
#include <optional>
#include <procman_lcm/cmd_desired_t.hpp>
#include <procman_lcm/cmd_t.hpp>
#include <string>

#include "procman/config.hpp"

namespace curbstone::procman {

/// What one order asks of one command, given how it is. Run ids say *which* life is meant: a sheriff that wants a
/// restart counts up, and the deputy acts when its own number differs. So an order can be lost or repeated without
/// harm.
enum class OrderStep {
  kNothing,
  kStart,     ///< start it, and take over the run id
  kStop,      ///< (begin to) stop it; a restart needs a later order, when it has ended
  kTakeRunId  ///< nothing to do, but remember the run id
};
[[nodiscard]] OrderStep decide(bool running, std::int32_t actual_runid, std::int32_t desired_runid, bool force_quit);

/// Orders older than this are ignored.
inline constexpr std::int64_t kStaleAfter = 60'000'000;  // us

/// A command as it comes off the wire, with what is out of range put back to the default. Nothing when its id or exec
/// cannot be used.
[[nodiscard]] std::optional<Command> command_from_wire(const procman_lcm::cmd_t& wire, const std::string& deputy);
[[nodiscard]] procman_lcm::cmd_t command_to_wire(const Command& command);

}  // namespace curbstone::procman
