#pragma once

#include <cstdint>
#include <string>

#include "tools/spy/board/bus_board.hpp"

namespace curbstone::exporter {

/// The state of the bus in Prometheus' text format, version 0.0.4 (prometheus.io, "Exposition formats"). `now`: us
/// since the Unix epoch. Unknown figures are left out. Pure.
[[nodiscard]] std::string metrics_text(const spy::board::BusBoard& board, std::int64_t now);

}  // namespace curbstone::exporter
