#include "tools/spy/view.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/message_types/field_values.hpp"
#include "common/message_types/type_table.hpp"

namespace curbstone::spy {

namespace {

using board::BusBoard;
using board::ChannelState;
using board::ServiceState;
using Align = TerminalTable::Align;
using Cell = TerminalTable::Cell;

constexpr double kSilent = 2.0;             // s after which a channel counts as silent
constexpr std::int64_t kClockOff = 50'000;  // us; a larger difference between two hosts' clocks is a fault

/// With this number of decimals; "-" for NaN.
std::string number(double value, int decimals) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals);
}

std::string milliseconds(double seconds) {
  return number(seconds * 1e3, 1);
}

std::string percent(double share) {
  return number(share * 100, 1);
}

Cell count_cell(std::optional<std::int64_t> count) {
  if (!count) return {"-", Colour::kDim};
  return {fmt::format("{}", *count), *count > 0 ? Colour::kBad : Colour::kPlain};
}

Cell rate_cell(double rate) {
  return {number(rate, 1), rate > 0 ? Colour::kBad : Colour::kPlain};
}

Cell clock_cell(std::int64_t clock) {
  return {fmt::format("{:+.1f}", static_cast<double>(clock) * 1e-3),
          std::abs(clock) > kClockOff ? Colour::kBad : Colour::kPlain};
}

void add_channel(const std::string& name, const ChannelState& channel, std::int64_t now, TerminalTable& table) {
  const board::ChannelRates rates = channel.statistics.rates(now);
  const double age = static_cast<double>(rates.age) * 1e-6;
  table.add_row({{name},
                 {number(rates.rate, 1)},
                 {milliseconds(rates.jitter)},
                 {number(rates.bandwidth * 1e-3, 1)},
                 {fmt::format("{}", channel.statistics.last_size())},
                 {number(age, 1), age > kSilent ? Colour::kWarning : Colour::kPlain},
                 count_cell(channel.statistics.lost()),
                 count_cell(channel.undecodable),
                 {channel.type.empty() ? "not known" : channel.type, Colour::kDim}});
}

void append_table(std::vector<std::string>& lines, const TerminalTable& table, const TextStyle& style) {
  if (!lines.empty()) lines.emplace_back();
  for (std::string& line : table.lines(style)) lines.push_back(std::move(line));
}

TerminalTable channel_table(const BusBoard& board, std::int64_t now) {
  TerminalTable table({{"channel"},
                       {"Hz", Align::kRight, 6},
                       {"jitter ms", Align::kRight},
                       {"kB/s", Align::kRight, 7},
                       {"bytes", Align::kRight, 5},
                       {"age s", Align::kRight, 5},
                       {"lost", Align::kRight},
                       {"undecodable", Align::kRight},
                       {"type"}});
  for (const auto& [name, channel] : board.channels()) add_channel(name, channel, now, table);
  return table;
}

Cell state_cell(const ServiceState& service, std::int64_t now) {
  if (service.is_silent(now)) return {"SILENT", Colour::kBad};
  if (service.status.fault.empty()) return {"ok", Colour::kGood};
  return {fmt::format("{}", fmt::join(service.status.fault, "; ")), Colour::kBad};
}

/// The state is the last column, because fault texts have any length.
TerminalTable service_table(const BusBoard& board, std::int64_t now) {
  TerminalTable table({{"service"},
                       {"host"},
                       {"CPU %", Align::kRight, 5},
                       {"MB", Align::kRight, 4},
                       {"p50 ms", Align::kRight},
                       {"p99 ms", Align::kRight},
                       {"lost/s", Align::kRight},
                       {"refused/s", Align::kRight},
                       {"state"}});
  for (const auto& [key, service] : board.services().services()) {
    table.add_row({{key.first},
                   {key.second},
                   {percent(service.cpu)},
                   {number(static_cast<double>(service.status.memory) * 1e-6, 0)},
                   {milliseconds(service.status.latency_p50)},
                   {milliseconds(service.status.latency_p99)},
                   rate_cell(service.dropped),
                   rate_cell(service.refused),
                   state_cell(service, now)});
  }
  return table;
}

TerminalTable deputy_table(const BusBoard& board, std::int64_t now) {
  TerminalTable table({{"deputy"},
                       {"CPU %", Align::kRight},
                       {"free MB", Align::kRight},
                       {"clock ms", Align::kRight},
                       {"age s", Align::kRight},
                       {"running", Align::kRight}});
  for (const auto& [name, deputy] : board.deputies()) {
    std::int64_t running = 0;
    for (const auto& command : deputy.info.cmds) running += command.pid != 0 ? 1 : 0;
    table.add_row({{name},
                   {percent(deputy.info.cpu_load)},
                   {number(static_cast<double>(deputy.info.phys_mem_free_bytes) * 1e-6, 0)},
                   clock_cell(deputy.clock),
                   {number(static_cast<double>(now - deputy.heard) * 1e-6, 1)},
                   {fmt::format("{}/{}", running, deputy.info.ncmds)}});
  }
  return table;
}

/// The fields of the followed channel's last message; empty if none can be decoded.
std::optional<std::vector<NamedValue>> followed_values(const BusBoard& board) {
  const auto found = board.channels().find(board.followed());
  if (found == board.channels().end()) return std::nullopt;
  const auto& bytes = found->second.last;
  return decode_values(TypeTable::built_in(), bytes.data(), bytes.size());
}

}  // namespace

std::vector<std::string> board_lines(const BusBoard& board, std::int64_t now, const TextStyle& style) {
  if (board.channels().empty()) return {"nothing comes: curbstone doctor looks for the reason"};
  std::vector<std::string> lines;
  append_table(lines, channel_table(board, now), style);
  if (board.unlisted() > 0)
    lines.push_back(styled_line(fmt::format("{} messages on more channels", board.unlisted()), Colour::kBad, style));
  if (!board.services().services().empty()) append_table(lines, service_table(board, now), style);
  if (!board.deputies().empty()) append_table(lines, deputy_table(board, now), style);
  return lines;
}

std::vector<std::string> message_lines(const BusBoard& board, std::int64_t now, const TextStyle& style) {
  const auto found = board.channels().find(board.followed());
  if (found == board.channels().end()) return {printable(board.followed()) + ": nothing comes"};
  TerminalTable table(
      {{"channel"}, {"Hz", Align::kRight}, {"age s", Align::kRight}, {"bytes", Align::kRight}, {"type"}});
  const ChannelState& channel = found->second;
  const board::ChannelRates rates = channel.statistics.rates(now);
  table.add_row({{found->first},
                 {number(rates.rate, 1)},
                 {number(static_cast<double>(rates.age) * 1e-6, 1)},
                 {fmt::format("{}", channel.statistics.last_size())},
                 {channel.type.empty() ? "not known" : channel.type}});
  std::vector<std::string> lines;
  append_table(lines, table, style);
  const auto values = followed_values(board);
  if (!values) {
    lines.push_back(styled_line("this message cannot be decoded", Colour::kBad, style));
    return lines;
  }
  TerminalTable fields({{"field"}, {"value"}});
  for (const NamedValue& value : *values) fields.add_row({{value.name}, {to_text(value.value)}});
  append_table(lines, fields, style);
  return lines;
}

}  // namespace curbstone::spy
