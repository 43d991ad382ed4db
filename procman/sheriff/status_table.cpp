#include "procman/sheriff/status_table.hpp"

#include <fmt/format.h>

namespace curbstone::procman::sheriff {

namespace {

constexpr double kMegabyte = 1e6;
constexpr std::int64_t kDeputySilence = 5'000'000;  // us: a deputy reports once a second

/// The last report of a deputy that is silent is not shown as the present state.
std::string state_cell(const CommandInfo& known, std::int64_t now) {
  return now - known.reported_at > kDeputySilence ? "unknown: deputy silent" : describe(known.status);
}

std::string heard_cell(const CommandInfo& known, std::int64_t now) {
  if (known.heard_at == 0) return "-";
  return fmt::format("{:.1f} s", static_cast<double>(now - known.heard_at) * 1e-6);
}

TerminalTable::Cell ready_cell(const CommandInfo& known) {
  if (known.status.pid == 0 || known.heard_at == 0) return {"-"};
  return known.ready() ? TerminalTable::Cell{"yes", Colour::kGood} : TerminalTable::Cell{"no", Colour::kBad};
}

}  // namespace

std::vector<std::string> status_table(const std::map<std::string, CommandInfo>& commands, std::int64_t now,
                                      const TextStyle& style) {
  constexpr auto kRight = TerminalTable::Align::kRight;
  TerminalTable table({{"COMMAND"},
                       {"STATE"},
                       {"CPU %", kRight, 6},
                       {"MB", kRight, 7},
                       {"RESTARTS", kRight},
                       {"READY", kRight},
                       {"HEARD", kRight, 7},
                       {"FAULTS"}});
  for (const auto& [id, known] : commands) {
    table.add_row({{id},
                   {state_cell(known, now)},
                   {fmt::format("{:.1f}", 100 * known.status.cpu_usage)},
                   {fmt::format("{:.1f}", static_cast<double>(known.status.mem_rss_bytes) / kMegabyte)},
                   {std::to_string(known.restarts)},
                   ready_cell(known),
                   {heard_cell(known, now)},
                   {fmt::to_string(fmt::join(known.faults, "; "))}});
  }
  return table.lines(style);
}

}  // namespace curbstone::procman::sheriff
