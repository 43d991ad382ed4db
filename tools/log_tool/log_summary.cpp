#include "tools/log_tool/log_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <curbstone/service_config_t.hpp>

#include "common/bus/decode.hpp"
#include "common/bytes/big_endian.hpp"

namespace curbstone::log_tool {

namespace {

constexpr std::int64_t kGap = 1'000'000;  // us
constexpr std::size_t kMostConfigs = 200;

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
  if (messages_++ == 0) begin_ = end_ = previous_ = utime;
  if (utime - previous_ >= kGap && gaps_.size() < kMostGaps)
    gaps_.push_back(fmt::format("{:.1f} .. {:.1f} s", to_seconds(previous_ - begin_), to_seconds(utime - begin_)));
  begin_ = std::min(begin_, utime);
  end_ = std::max(end_, utime);
  previous_ = utime;

  ChannelSummary& channel = channels_[event.channel];
  if (channel.messages++ == 0) channel.first_utime = channel.last_utime = utime;
  channel.bytes += static_cast<std::int64_t>(event.bytes.size());
  channel.longest_gap = std::max(channel.longest_gap, utime - channel.last_utime);
  channel.last_utime = std::max(channel.last_utime, utime);
  if (event.bytes.size() >= 8 && channel.fingerprints.size() < ChannelSummary::kMostFingerprints)
    channel.fingerprints.insert(static_cast<std::int64_t>(read_big_endian<std::uint64_t>(event.bytes)));

  service_config_t config;
  if (event.channel == "CONFIG" && configs_.size() < kMostConfigs &&
      decode(event.bytes.data(), static_cast<int>(event.bytes.size()), config))
    configs_.insert(fmt::format("{} on {}, version {}", config.service, config.host, config.version));
}

}  // namespace curbstone::log_tool
