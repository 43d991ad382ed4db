#include "services/recorder/recording.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <utility>

namespace curbstone::recorder {

Recording::Recording(std::string file, std::int64_t split) : file_(std::move(file)), split_(split) {
  open();
}

void Recording::open() {
  current_ = file_;
  for (int n = 1; std::filesystem::exists(current_); ++n) current_ = fmt::format("{}.{}", file_, n);
  log_.emplace(current_);
  flushed_ = 0;
}

void Recording::write(const std::string& channel, const void* data, int size, std::int64_t utime) {
  if (split_ > 0 && log_->bytes() >= split_) {
    flush();
    open();
  }
  try {
    log_->write(channel, data, size, utime);
  } catch (const std::runtime_error&) {
    give_up();
    throw;
  }
}

void Recording::flush() {
  try {
    log_->flush();
  } catch (const std::runtime_error&) {
    give_up();
    throw;
  }
  flushed_ = log_->bytes();
}

void Recording::give_up() {
  log_.reset();
  std::error_code ignored;
  if (flushed_ == 0) std::filesystem::remove(current_, ignored);
}

}  // namespace curbstone::recorder
