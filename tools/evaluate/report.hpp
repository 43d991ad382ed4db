#pragma once

#include <string>

#include "tools/evaluate/evaluation.hpp"

namespace curbstone::evaluate {

/// As a table, for people.
[[nodiscard]] std::string to_table(const Evaluation& evaluation);

/// As JSON: {"curb": {"0.12": {"precision", "recall", "f1"}, ...}, "lateral_cm": {"median", "p95", "bias", "spread"},
/// "classes": {"accuracy", "confusion"}, "trajectory": {"distance_m", "ate_m", "rpe_percent", ...}, "dropped":
/// {"packets", "messages", "by_recorder", "by_recorder_channels"}, "latency_ms": {"p50", "p95", "p99", "max", "stages":
/// {"<channel>": {"p50", ...}}}, "start_s": {"<channel>": x, "set_off"}, "cores": {"<process>": x}, "processes":
/// [{"name", "cores", "memory_mb", "own_memory_mb", "own_memory_after_a_minute_mb"}]}. Rows of the confusion are the
/// truth. Unknown figures are null.
[[nodiscard]] std::string to_json(const Evaluation& evaluation);

}  // namespace curbstone::evaluate
