#pragma once

#include <string>
#include <vector>

#include "common/terminal/terminal_table.hpp"
#include "tools/doctor/checks/verdict.hpp"

namespace curbstone::doctor {

/// One line per verdict, with the fix of a finding, and a last line with their counts.
[[nodiscard]] std::vector<std::string> report_lines(const checks::Verdicts& verdicts, const TextStyle& style);

/// {"findings": 1, "checks": [{"check": "route", "kind": "good" | "finding" | "unknown", "what": ..., "fix": ...}]}
[[nodiscard]] std::string report_json(const checks::Verdicts& verdicts);

/// 0: no findings; 1: there is a finding.
[[nodiscard]] int exit_status(const checks::Verdicts& verdicts);

}  // namespace curbstone::doctor
