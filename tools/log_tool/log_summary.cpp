#include "tools/log_tool/log_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <curbstone/service_config_t.hpp>
#include <iterator>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/bytes/big_endian.hpp"

namespace curbstone::log_tool {

namespace {

constexpr std::int64_t kGap = 1'000'000;  // us
constexpr std::size_t kMaxConfigs = 200;

double to_seconds(std::int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

}  // namespace

double ChannelSummary::hz() const {
  const double seconds = to_seconds(last_utime - first_utime);
  return seconds > 0 ? static_cast<double>(messages - 1) / seconds : 0;
}

void LogSummary::take(const LogEvent& event) {
  const std::int64_t utime = event.log_utime;
  if (messages_++ == 0) begin_ = end_ = utime;
  begin_ = std::min(begin_, utime);
  end_ = std::max(end_, utime);
  cover(utime);

  ChannelSummary& channel = channels_[event.channel];
  if (channel.messages++ == 0) channel.first_utime = channel.last_utime = channel.previous_utime = utime;
  channel.first_utime = std::min(channel.first_utime, utime);
  channel.bytes += static_cast<std::int64_t>(event.bytes.size());
  channel.longest_gap = std::max(channel.longest_gap, utime - channel.last_utime);
  channel.last_utime = std::max(channel.last_utime, utime);
  channel.farthest_back = std::max(channel.farthest_back, std::exchange(channel.previous_utime, utime) - utime);
  if (event.bytes.size() >= 8 && channel.fingerprints.size() < ChannelSummary::kMaxFingerprints)
    channel.fingerprints.insert(static_cast<std::int64_t>(read_big_endian<std::uint64_t>(event.bytes)));

  service_config_t config;
  if (event.channel == "CONFIG" && configs_.size() < kMaxConfigs &&
      decode(event.bytes.data(), static_cast<int>(event.bytes.size()), config))
    configs_.insert(fmt::format("{} on {}, version {}", config.service, config.host, config.version));
}

void LogSummary::cover(std::int64_t utime) {
  const auto after = spans_.upper_bound(utime);
  const auto before = after == spans_.begin() ? spans_.end() : std::prev(after);
  const bool joins_before = before != spans_.end() && utime - before->second < kGap;
  const bool joins_after = after != spans_.end() && after->first - utime < kGap;
  if (joins_before) {
    before->second = std::max(before->second, joins_after ? after->second : utime);
    if (joins_after) spans_.erase(after);
  } else if (joins_after) {
    const std::int64_t to = after->second;
    spans_.emplace_hint(spans_.erase(after), utime, to);
  } else if (spans_.size() < kMaxSpans) {
    spans_.emplace_hint(after, utime, utime);
  }
}

std::string LogSummary::back() const {
  std::int64_t farthest = 0;
  std::vector<std::string> names;
  for (const auto& [name, channel] : channels_) {
    if (channel.farthest_back < kGap) continue;
    farthest = std::max(farthest, channel.farthest_back);
    names.push_back(name);
  }
  return names.empty() ? "" : fmt::format("{:.1f} s ({})", to_seconds(farthest), fmt::join(names, ", "));
}

std::vector<std::string> LogSummary::gaps() const {
  std::vector<std::string> gaps;
  for (auto span = spans_.begin(); span != spans_.end() && gaps.size() < kMaxGaps; ++span) {
    if (const auto next = std::next(span); next != spans_.end())
      gaps.push_back(
          fmt::format("{:.1f} .. {:.1f} s", to_seconds(span->second - begin_), to_seconds(next->first - begin_)));
  }
  return gaps;
}

}  // namespace curbstone::log_tool
