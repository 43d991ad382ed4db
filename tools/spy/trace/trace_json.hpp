#pragma once

#include <string>

#include "tools/spy/trace/chain_trace.hpp"

namespace curbstone::spy::trace {

/// The trace in Chrome's format (Trace Event Format, JSON object), which Perfetto opens. Times are relative to the
/// first measurement, us.
[[nodiscard]] std::string trace_json(const ChainTrace& trace);

}  // namespace curbstone::spy::trace
