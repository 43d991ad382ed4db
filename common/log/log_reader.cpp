#include "common/log/log_reader.hpp"

#include <fmt/format.h>
#include <lcm/eventlog.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace curbstone {

LogReader::LogReader(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file))
    throw std::runtime_error(fmt::format("{}: cannot be read: {}", file, in ? "it is a folder" : std::strerror(errno)));
  // Every record of an LCM log opens with this sync word.
  constexpr unsigned char kSync[4] = {0xED, 0xA1, 0xDA, 0x01};
  char head[4] = {};
  in.read(head, sizeof head);
  if (in.gcount() != sizeof head || std::memcmp(head, kSync, sizeof kSync) != 0) {
    throw std::runtime_error(fmt::format("{}: not an LCM log (it does not begin with a record of lcm-logger)", file));
  }
  size_ = static_cast<std::int64_t>(std::filesystem::file_size(file));
  log_ = lcm_eventlog_create(file.c_str(), "r");
  if (log_ == nullptr) throw std::runtime_error(fmt::format("{}: cannot be opened as an LCM log", file));
}

LogReader::~LogReader() {
  if (log_ != nullptr) lcm_eventlog_destroy(log_);
}

std::optional<LogEvent> LogReader::next() {
  const auto before = std::ftell(log_->f);
  lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log_);
  if (event == nullptr) {
    truncated_ = before < size_;
    return std::nullopt;
  }
  const auto* bytes = static_cast<const std::uint8_t*>(event->data);
  LogEvent out{
      event->timestamp, {event->channel, static_cast<std::size_t>(event->channellen)}, {bytes, bytes + event->datalen}};
  lcm_eventlog_free_event(event);
  read_to_ = std::ftell(log_->f);
  return out;
}

double LogReader::progress() const {
  return size_ > 0 ? static_cast<double>(std::ftell(log_->f)) / static_cast<double>(size_) : 1.0;
}

}  // namespace curbstone
