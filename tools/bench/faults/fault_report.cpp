#include "tools/bench/faults/fault_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "common/terminal/terminal_table.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::faults {

std::vector<std::string> table_lines(const FaultReport& report) {
  constexpr auto kRight = TerminalTable::Align::kRight;
  TerminalTable table({{"fault"},
                       {"cells differ", kRight},
                       {"poses missing", kRight},
                       {"back s", kRight},
                       {"map"},
                       {"clean end"},
                       {"emulator late s", kRight},
                       {"said"}});
  for (const FaultRow& row : report.rows) {
    table.add_row({{row.fault},
                   {fmt::to_string(row.cells_differ)},
                   {fmt::to_string(row.poses_missing)},
                   {row.back_s ? fmt::format("{:.1f}", *row.back_s) : "not"},
                   {row.map},
                   {row.ended_cleanly ? "yes" : "NO"},
                   {fmt::format("{:.2f}", row.emulator_late_s)},
                   {fmt::format("{}", fmt::join(row.said, "; "))}});
  }
  return table.lines();
}

void write_report(const FaultReport& report, const std::string& file) {
  nlohmann::json json{{"undisturbed", nlohmann::json::array()}, {"rows", nlohmann::json::array()}};
  for (const Undisturbed& drive : report.undisturbed)
    json["undisturbed"].push_back({{"seconds", drive.seconds}, {"cells", drive.cells}, {"poses", drive.poses}});
  for (const FaultRow& row : report.rows) {
    json["rows"].push_back({{"fault", row.fault},
                            {"cells_differ", row.cells_differ},
                            {"poses_missing", row.poses_missing},
                            {"back_s", row.back_s ? nlohmann::json(*row.back_s) : nlohmann::json()},
                            {"said", fmt::format("{}", fmt::join(row.said, "; "))},
                            {"ended_cleanly", row.ended_cleanly},
                            {"map", row.map},
                            {"emulator_late_s", row.emulator_late_s}});
  }
  output::write_text(file, json.dump(2) + '\n');
}

}  // namespace curbstone::bench::faults
