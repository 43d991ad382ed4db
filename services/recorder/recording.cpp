#include "services/recorder/recording.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace curbstone::recorder {

std::string unused_name(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw std::runtime_error(
        fmt::format("recorder.file: {} is a folder: name a file in it, or set recorder.folder to it", file));
  std::string name = file;
  for (int n = 1; std::filesystem::exists(name); ++n) name = fmt::format("{}.{}", file, n);
  return name;
}

Recording::Recording(NextName next_name, std::int64_t split, Head head)
    : next_name_(std::move(next_name)), split_(split), head_(std::move(head)) {
  open();
}

namespace {

/// Zeros if there is no such file.
std::pair<std::uint64_t, std::uint64_t> identity_of(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino};
}

}  // namespace

void Recording::open() {
  current_ = next_name_();
  log_.emplace(current_);
  identity_ = identity_of(current_);
  flushed_ = num_records_ = 0;
}

bool Recording::is_there() const {
  return identity_of(current_) == identity_;
}

void Recording::write(const std::string& channel, const void* data, int size, std::int64_t utime) {
  if (split_ > 0 && log_->bytes() >= split_) {
    flush();
    open();
  }
  try {
    if (log_->bytes() == 0 && head_) head_(*log_, utime);
    log_->write(channel, data, size, utime);
    ++num_records_;
  } catch (const std::runtime_error&) {
    give_up();
    throw;
  }
}

void Recording::flush() {
  try {
    log_->flush();
    if (!is_there()) {
      flushed_ = -1;  // nothing of ours is to be removed
      throw FileDeleted(fmt::format("{}: was deleted while it was written, with {} messages", current_, num_records_));
    }
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
