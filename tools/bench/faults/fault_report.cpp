#include "tools/bench/faults/fault_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "common/terminal/terminal_table.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::faults {

namespace {

std::string cell(const std::optional<int>& figure) {
  return figure ? fmt::to_string(*figure) : "spoiled";
}

nlohmann::json or_null(const auto& figure) {
  return figure ? nlohmann::json(*figure) : nlohmann::json();
}

}  // namespace

std::string to_line(const Undisturbed& drive) {
  const std::string said = drive.said.empty() ? "" : fmt::format("; said: {}", fmt::join(drive.said, "; "));
  return fmt::format(
      "undisturbed {:.0f} s: {} cells, {} poses, emulator {:.2f} s late, {} revolutions lost; its live map: {} cells "
      "differ, {} poses missing{}{}",
      drive.seconds, drive.cells, drive.poses, drive.emulator_late_s, drive.revolutions_lost, drive.live_cells_differ,
      drive.live_poses_missing, said,
      drive.is_spoiled() ? ". SPOILED by a busy machine: nothing is compared with it" : "");
}

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
                   {cell(row.cells_differ)},
                   {cell(row.poses_missing)},
                   {row.is_spoiled() ? "spoiled"
                    : row.back_s     ? fmt::format("{:.1f}", *row.back_s)
                                     : "not"},
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
    json["undisturbed"].push_back({{"seconds", drive.seconds},
                                   {"cells", drive.cells},
                                   {"poses", drive.poses},
                                   {"emulator_late_s", drive.emulator_late_s},
                                   {"revolutions_lost", drive.revolutions_lost},
                                   {"live_cells_differ", drive.live_cells_differ},
                                   {"live_poses_missing", drive.live_poses_missing},
                                   {"said", fmt::format("{}", fmt::join(drive.said, "; "))},
                                   {"spoiled", drive.is_spoiled()}});
  for (const FaultRow& row : report.rows) {
    json["rows"].push_back({{"fault", row.fault},
                            {"cells_differ", or_null(row.cells_differ)},
                            {"poses_missing", or_null(row.poses_missing)},
                            {"back_s", or_null(row.back_s)},
                            {"said", fmt::format("{}", fmt::join(row.said, "; "))},
                            {"ended_cleanly", row.ended_cleanly},
                            {"map", row.map},
                            {"emulator_late_s", row.emulator_late_s},
                            {"drives", row.drives},
                            {"seconds", row.seconds},
                            {"excuse", row.excuse.why},
                            {"spoiled", row.is_spoiled()}});
  }
  output::write_text(file, json.dump(2) + '\n');
}

}  // namespace curbstone::bench::faults
