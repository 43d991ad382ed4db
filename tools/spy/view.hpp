#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/terminal/terminal_table.hpp"
#include "tools/spy/board/bus_board.hpp"

namespace curbstone::spy {

/// The whole board: channels, services, deputies. `now`: us since the Unix epoch.
[[nodiscard]] std::vector<std::string> board_lines(const board::BusBoard& board, std::int64_t now,
                                                   const TextStyle& style);
/// The last message of the followed channel, one line per field.
[[nodiscard]] std::vector<std::string> message_lines(const board::BusBoard& board, std::int64_t now,
                                                     const TextStyle& style);

/// {"channels": [...], "services": [...], "deputies": [...], "message": {...}}; the message is that of the followed
/// channel, field by field. Unknown values are null.
[[nodiscard]] std::string board_json(const board::BusBoard& board, std::int64_t now);

}  // namespace curbstone::spy
