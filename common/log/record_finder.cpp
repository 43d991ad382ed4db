#include "common/log/record_finder.hpp"

#include <algorithm>
#include <array>

#include "common/bytes/big_endian.hpp"

namespace curbstone {

namespace {

constexpr std::array<std::uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::int64_t kMaxChannelSize = 255;   // LCM's names have at most 63
constexpr std::int64_t kMaxDataSize = 1 << 28;  // as in LCM
constexpr std::size_t kReadAhead = 1 << 18;

bool is_sync(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kSync.size() && std::equal(kSync.begin(), kSync.end(), bytes.begin());
}

}  // namespace

std::optional<LogRecord> RecordFinder::header_at(std::int64_t at, bool any_sync) {
  const auto bytes = file_.at(at, LogRecord::kHeader);
  if (bytes.size() < LogRecord::kHeader || !(any_sync || is_sync(bytes))) return std::nullopt;
  const auto int64_at = [&](std::size_t i) {
    return static_cast<std::int64_t>(read_big_endian<std::uint64_t>(bytes.subspan(i)));
  };
  const auto int32_at = [&](std::size_t i) {
    return static_cast<std::int32_t>(read_big_endian<std::uint32_t>(bytes.subspan(i)));
  };
  const LogRecord record{at, int64_at(4), int64_at(12), int32_at(20), int32_at(24)};
  if (record.channel_size < 1 || record.channel_size > kMaxChannelSize) return std::nullopt;
  if (record.data_size < 0 || record.data_size > kMaxDataSize) return std::nullopt;
  const auto channel = file_.at(at + LogRecord::kHeader, static_cast<std::size_t>(record.channel_size));
  if (!std::all_of(channel.begin(), channel.end(), [](std::uint8_t c) { return c > ' ' && c < 0x7F; }))
    return std::nullopt;
  return record;
}

bool RecordFinder::ends_at_sync(const LogRecord& record) {
  if (record.end() >= file_.size()) return record.end() == file_.size();
  // Reads the bytes of the next record too, because the caller wants it next.
  const auto length = static_cast<std::size_t>(record.end() - record.begin) + kSync.size();
  if (length > kReadAhead) return is_sync(file_.at(record.end(), kSync.size()));
  const auto bytes = file_.at(record.begin, length);
  return bytes.size() == length && is_sync(bytes.last(kSync.size()));
}

std::optional<LogRecord> RecordFinder::confirmed_from(std::int64_t from) {
  const bool known = searched_from_ >= 0 && searched_from_ <= from && from <= searched_to_;
  if (known) return confirmed_;
  searched_from_ = from;
  confirmed_.reset();
  for (std::int64_t at = file_.find(kSync, from); at < file_.size(); at = file_.find(kSync, at + 1)) {
    const auto record = header_at(at, false);
    if (record && ends_at_sync(*record)) {
      confirmed_ = record;
      break;
    }
  }
  searched_to_ = confirmed_ ? confirmed_->begin : file_.size();
  return confirmed_;
}

bool RecordFinder::fits_what_follows(const LogRecord& record) {
  if (record.end() > file_.size()) return false;
  if (ends_at_sync(record)) return true;
  const auto follower = header_at(record.end(), true);
  if (follower && record.is_followed_by(*follower) && ends_at_sync(*follower)) return true;
  const auto next = confirmed_from(record.begin + 1);
  if (!next) return true;
  // The record is wrong if the next one begins inside it. It is also wrong if its direct successor begins behind its
  // end: the bytes in between belong to it, so its lengths are wrong.
  return next->begin >= record.end() && !record.is_followed_by(*next);
}

std::optional<LogRecord> RecordFinder::record_at(std::int64_t at, const std::optional<LogRecord>& previous) {
  auto record = header_at(at, false);
  if (record && fits_what_follows(*record)) return record;
  if (record || !previous) return std::nullopt;
  record = header_at(at, true);
  if (record && previous->is_followed_by(*record) && ends_at_sync(*record)) return record;
  return std::nullopt;
}

std::optional<LogRecord> RecordFinder::first_from(std::int64_t from) {
  for (std::int64_t at = file_.find(kSync, from); at < file_.size(); at = file_.find(kSync, at + 1)) {
    if (const auto record = record_at(at)) return record;
  }
  return std::nullopt;
}

bool RecordFinder::is_sync_at(std::int64_t at) {
  return is_sync(file_.at(at, kSync.size()));
}

bool RecordFinder::cut_off_at(std::int64_t at) {
  const auto bytes = file_.at(at, kSync.size());
  if (bytes.empty() || !std::equal(bytes.begin(), bytes.end(), kSync.begin())) return false;
  if (file_.size() - at < LogRecord::kHeader) return true;
  const auto record = header_at(at, false);
  return record && record->end() > file_.size();
}

}  // namespace curbstone
