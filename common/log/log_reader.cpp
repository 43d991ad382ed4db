#include "common/log/log_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "common/file_kind/file_kind.hpp"

namespace curbstone {

namespace {

/// us. A damaged time may be any number. Times are clamped to this, so that the difference of two does not overflow.
constexpr std::int64_t kMaxTime = std::numeric_limits<std::int64_t>::max() / 4;

}  // namespace

LogReader::LogReader(const std::string& file) : file_(file), finder_(file_) {
  if (file_.size() == 0) throw std::runtime_error(fmt::format("{}: not an LCM log: it is empty", file));
  // At once: the search for a record goes through all gigabytes of a bag.
  const std::string_view kind = finder_.is_sync_at(0) ? "" : file_kind(file_.at(0, kFileKindBytes));
  if (!kind.empty()) throw std::runtime_error(fmt::format("{}: not an LCM log, but {}", file, kind));
  if (!finder_.cut_off_at(0) && !finder_.first_from(0))
    throw std::runtime_error(fmt::format("{}: not an LCM log (no record of lcm-logger is in it)", file));
}

std::optional<LogEvent> LogReader::next() {
  const auto record = next_record();
  if (!record) return std::nullopt;
  const auto bytes = file_.at(record->begin, static_cast<std::size_t>(record->end() - record->begin));
  const auto channel = bytes.subspan(LogRecord::kHeader, static_cast<std::size_t>(record->channel_size));
  const auto data = bytes.subspan(static_cast<std::size_t>(LogRecord::kHeader + record->channel_size));
  previous_ = record;
  at_ = record->end();
  return LogEvent{
      std::clamp(record->utime, -kMaxTime, kMaxTime), {channel.begin(), channel.end()}, {data.begin(), data.end()}};
}

std::optional<LogRecord> LogReader::next_record() {
  if (at_ >= file_.size()) return std::nullopt;
  if (const auto record = finder_.record_at(at_, previous_)) return record;
  const auto found = finder_.first_from(at_ + 1);
  skip(found);
  return found;
}

void LogReader::skip(const std::optional<LogRecord>& to) {
  const std::int64_t end = to ? to->begin : file_.size();
  if (!to && finder_.cut_off_at(at_)) {
    loss_.cut_off += end - at_;
  } else {
    ++loss_.places;
    loss_.bytes += end - at_;
    if (to && previous_) {
      loss_.missing += previous_->missing_until(*to);
      loss_.seconds += std::abs(static_cast<double>(to->utime) - static_cast<double>(previous_->utime)) * 1e-6;
    }
  }
  at_ = end;
}

double LogReader::progress() const {
  return file_.size() > 0 ? static_cast<double>(at_) / static_cast<double>(file_.size()) : 1.0;
}

}  // namespace curbstone
