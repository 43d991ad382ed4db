#include "procman/sheriff/status_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone::procman::sheriff {

namespace {

constexpr double kMegabyte = 1e6;
constexpr std::int64_t kSilence = 5'000'000;  // us: a deputy reports once a second

/// What a deputy that is gone said last is not shown as the present.
std::string state_cell(const Known& known, std::int64_t now) {
  return now - known.reported_at > kSilence ? "unknown: deputy silent" : describe(known.status);
}

std::string heard_cell(const Known& known, std::int64_t now) {
  if (known.heard_at == 0) return "-";
  return fmt::format("{:.1f} s", static_cast<double>(now - known.heard_at) * 1e-6);
}

std::string ready_cell(const Known& known) {
  if (known.status.pid == 0 || known.heard_at == 0) return "-";
  return known.faults.empty() ? "yes" : "no";
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown(text);
  std::replace_if(
      shown.begin(), shown.end(),
      [](char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }, '?');
  return shown;
}

std::string status_table(const std::map<std::string, Known>& commands, std::int64_t now) {
  std::size_t id_width = 7;
  std::size_t state_width = 5;
  for (const auto& [id, known] : commands) {
    id_width = std::max(id_width, id.size());
    state_width = std::max(state_width, state_cell(known, now).size());
  }
  std::string table = fmt::format("{:<{}}  {:<{}}  {:>6}  {:>7}  {:>8}  {:>5}  {:>7}  {}\n", "COMMAND", id_width,
                                  "STATE", state_width, "CPU %", "MB", "RESTARTS", "READY", "HEARD", "FAULTS");
  for (const auto& [id, known] : commands) {
    std::string faults;
    for (const std::string& fault : known.faults) faults += (faults.empty() ? "" : "; ") + printable(fault);
    std::string line = fmt::format("{:<{}}  {:<{}}  {:>6.1f}  {:>7.1f}  {:>8}  {:>5}  {:>7}  {}", printable(id),
                                   id_width, state_cell(known, now), state_width, 100 * known.status.cpu_usage,
                                   static_cast<double>(known.status.mem_rss_bytes) / kMegabyte, known.restarts,
                                   ready_cell(known), heard_cell(known, now), faults);
    line.erase(line.find_last_not_of(' ') + 1);
    table += line + "\n";
  }
  return table;
}

}  // namespace curbstone::procman::sheriff
