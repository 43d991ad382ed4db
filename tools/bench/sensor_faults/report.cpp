#include "tools/bench/sensor_faults/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/terminal/terminal_table.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::sensor_faults {

namespace {

std::string words_of(const Said& said) {
  return said.service + ": " + said.words;
}

/// The fault that was reported first; without one, the counter that counted first.
const Said* first_of(const Row& row) {
  if (!row.faults.empty()) return &row.faults.front();
  return row.counters.empty() ? nullptr : &row.counters.front();
}

nlohmann::json to_json(const std::vector<Said>& said, double from) {
  auto json = nlohmann::json::array();
  for (const Said& one : said)
    json.push_back({{"service", one.service}, {"words", one.words}, {"after_s", one.at - from}});
  return json;
}

nlohmann::json to_json(const Row& row) {
  nlohmann::json json{{"sensor", row.sensor},
                      {"fault", row.name},
                      {"words", row.words},
                      {"from_s", row.from},
                      {"failure", row.failure},
                      {"verdict", row.verdict()},
                      {"faults", to_json(row.faults, row.from)},
                      {"counters", to_json(row.counters, row.from)}};
  if (row.map)
    json.update({{"f1", row.map->f1},
                 {"precision", row.map->precision},
                 {"recall", row.map->recall},
                 {"class_accuracy", row.map->class_accuracy},
                 {"ate_m", row.map->ate}});
  const Said* first = first_of(row);
  json["said_first"] = first ? fmt::format("{:.1f} s: {}", first->at - row.from, words_of(*first)) : "nothing";
  std::string later;
  for (std::size_t i = 1; i < row.faults.size(); ++i) later += (later.empty() ? "" : "; ") + words_of(row.faults[i]);
  json["said_later"] = later;
  return json;
}

}  // namespace

std::string Row::verdict() const {
  if (!faults.empty()) return is_bad() ? "bad, named" : "good, named";
  if (!counters.empty()) return is_bad() ? "BAD, counted" : "good, counted";
  return is_bad() ? "BAD, UNNAMED" : "good";
}

Row row_of(const catalogue::Fault& fault, const Outcome& outcome, const Outcome& undisturbed) {
  return {.sensor = fault.sensor,
          .name = fault.name,
          .words = fault.words,
          .from = fault.from,
          .map = outcome.map,
          .failure = outcome.failure,
          .faults = outcome.witness.new_faults(undisturbed.witness, fault.from),
          .counters = outcome.witness.new_counters(undisturbed.witness, fault.from)};
}

std::vector<std::string> table_lines(const std::vector<Row>& rows) {
  constexpr auto kRight = TerminalTable::Align::kRight;
  TerminalTable table({{"sensor"},
                       {"fault"},
                       {"from s", kRight},
                       {"F1", kRight},
                       {"P", kRight},
                       {"R", kRight},
                       {"classes", kRight},
                       {"ATE m", kRight},
                       {"outcome"},
                       {"after s", kRight},
                       {"said first"}});
  const auto figure = [](const Row& row, double MapFigures::*member) {
    return row.map ? fmt::format("{:.3f}", (*row.map).*member) : std::string("-");
  };
  for (const Row& row : rows) {
    const Said* first = first_of(row);
    table.add_row({{row.sensor},
                   {row.name},
                   {fmt::format("{:.0f}", row.from)},
                   {figure(row, &MapFigures::f1)},
                   {figure(row, &MapFigures::precision)},
                   {figure(row, &MapFigures::recall)},
                   {figure(row, &MapFigures::class_accuracy)},
                   {figure(row, &MapFigures::ate)},
                   {row.verdict()},
                   {first ? fmt::format("{:.1f}", first->at - row.from) : ""},
                   {(first ? words_of(*first) : "") + (row.failure.empty() ? "" : " [" + row.failure + "]")}});
  }
  return table.lines();
}

void write_report(const std::vector<Row>& rows, const std::string& file) {
  const auto count = [&](auto is) { return std::ranges::count_if(rows, is); };
  nlohmann::json json{{"good_f1", kGoodF1},
                      {"rows", nlohmann::json::array()},
                      {"counts",
                       {{"faults", std::max<std::ptrdiff_t>(0, std::ssize(rows) - 1)},
                        {"bad_named", count([](const Row& row) { return row.is_bad() && !row.faults.empty(); })},
                        {"bad_unnamed", count([](const Row& row) { return row.is_bad() && row.faults.empty(); })}}}};
  for (const Row& row : rows) json["rows"].push_back(to_json(row));
  output::write_text(file, json.dump(1) + '\n');
}

}  // namespace curbstone::bench::sensor_faults
