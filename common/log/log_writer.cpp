#include "common/log/log_writer.hpp"

#include <lcm/eventlog.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "common/log/message_order.hpp"

namespace curbstone {

namespace {

constexpr std::int64_t kRecordHeader = 28;  // sync word, number, time, two lengths

std::system_error cannot_be_written(const std::string& file) {
  return {errno, std::generic_category(), file + ": cannot be written"};
}

}  // namespace

LogWriter::LogWriter(const std::string& file) : file_(file), log_(lcm_eventlog_create(file.c_str(), "w")) {
  if (log_ == nullptr) throw cannot_be_written(file);
}

LogWriter::~LogWriter() {
  lcm_eventlog_destroy(log_);
}

void LogWriter::write(const std::string& channel, const void* data, int size, std::int64_t log_utime) {
  lcm_eventlog_event_t event{};
  event.eventnum = count_++;
  event.timestamp = log_utime != 0 ? log_utime : message_time(data, static_cast<std::size_t>(size));
  event.channellen = static_cast<std::int32_t>(channel.size());
  event.datalen = size;
  event.channel = const_cast<char*>(channel.c_str());  // the C interface does not write to it
  event.data = const_cast<void*>(data);
  if (lcm_eventlog_write_event(log_, &event) != 0) throw cannot_be_written(file_);
  bytes_ += kRecordHeader + event.channellen + event.datalen;
}

void LogWriter::flush() {
  if (std::fflush(log_->f) != 0) throw cannot_be_written(file_);
}

}  // namespace curbstone
