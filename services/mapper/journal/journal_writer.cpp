#include "services/mapper/journal/journal_writer.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::mapper::journal {
namespace {

constexpr std::int64_t kMaxBusy = 60'000'000'000;  // ns
constexpr std::size_t kSpare = 1'000'000;          // bytes: room for further batches

}  // namespace

JournalWriter::~JournalWriter() {
  if (under_way_.valid()) under_way_.wait();
}

bool JournalWriter::busy() {
  if (!under_way_.valid()) return false;
  if (under_way_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  if (const std::error_code error = under_way_.get()) {
    error_ = error;
    fault_ = fmt::format("{}: {}", path_, error.message());
  }
  return false;
}

bool JournalWriter::is_stuck() const {
  return under_way_.valid() && steady_clock() - began_ > kMaxBusy;
}

bool JournalWriter::has_room_again() const {
  if (error_ == std::errc::no_such_file_or_directory) return true;
  if (error_ != std::errc::no_space_on_device) return false;
  std::error_code error;
  const auto space = std::filesystem::space(std::filesystem::path(path_).parent_path(), error);
  return !error && space.available > bytes_ + bytes_ / 4 + kSpare;
}

void JournalWriter::begin() {
  is_open_ = is_in_place_ = is_full_ = false;
  after_.reset();
  bytes_ = 0;
  error_.clear();
  fault_.clear();
}

void JournalWriter::continue_at(std::size_t bytes) {
  begin();
  after_ = bytes;
  bytes_ = bytes;
  is_in_place_ = was_in_place_ = true;
}

void JournalWriter::append(std::string batch, bool is_complete) {
  began_ = steady_clock();
  bytes_ += batch.size();
  if (bytes_ > max_bytes_) {
    is_full_ = true;
    fault_ = fmt::format("{} would be larger than {} MB", path_, max_bytes_ / 1'000'000);
    under_way_ = std::async(std::launch::async, [this] {
      discard();
      return std::error_code();
    });
    return;
  }
  const bool opens = !std::exchange(is_open_, true);
  const bool takes_place = is_complete && !is_in_place_;
  is_in_place_ = is_in_place_ || is_complete;
  was_in_place_ = was_in_place_ || is_complete;
  const bool waits_beside = was_in_place_ && !is_in_place_;
  const auto after = std::exchange(after_, std::nullopt);
  under_way_ =
      std::async(std::launch::async, [this, batch = std::move(batch), opens, after, takes_place, waits_beside] {
        if (opens) open(after);
        const std::error_code error = put(batch, takes_place);
        if (error)
          discard();
        else if (waits_beside)
          keep_alive();
        return error;
      });
}

/// Opens the file in place after so many bytes, or a new one beside it. put() reports the error. Runs in the other
/// thread.
void JournalWriter::open(std::optional<std::size_t> after) {
  std::error_code ignored;
  errno = 0;
  has_taken_place_ = after.has_value();
  if (after) {
    file_.reset(truncate(path_.c_str(), static_cast<off_t>(*after)) == 0 ? std::fopen(path_.c_str(), "abe") : nullptr);
  } else {
    std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
    file_.reset(std::fopen(unfinished().c_str(), "wbe"));
  }
}

/// Runs in the other thread.
std::error_code JournalWriter::put(std::string_view batch, bool takes_place) {
  if (file_) errno = 0;
  if (file_ && !is_there()) return std::make_error_code(std::errc::no_such_file_or_directory);
  const bool is_written = file_ && std::fwrite(batch.data(), 1, batch.size(), file_.get()) == batch.size() &&
                          std::fflush(file_.get()) == 0 &&
                          (!takes_place || std::rename(unfinished().c_str(), path_.c_str()) == 0);
  has_taken_place_ = has_taken_place_ || (is_written && takes_place);
  return is_written ? std::error_code() : std::error_code(errno != 0 ? errno : EIO, std::generic_category());
}

void JournalWriter::keep_young() {
  began_ = steady_clock();
  under_way_ = std::async(std::launch::async, [this] {
    keep_alive();
    return std::error_code();
  });
}

/// Whether the file still has its name: the one that it has until it takes its place, or that place. Runs in the other
/// thread.
bool JournalWriter::is_there() const {
  struct stat named {
  }, ours{};
  const std::string name = has_taken_place_ ? path_ : unfinished();
  return stat(name.c_str(), &named) == 0 && fstat(fileno(file_.get()), &ours) == 0 && named.st_ino == ours.st_ino &&
         named.st_dev == ours.st_dev;
}

/// Runs in the other thread. Until the new file is whole, a successor has the one of this drive that it will replace,
/// and the file's age shows how long nothing has been written. A file of another drive keeps its age.
void JournalWriter::keep_alive() const {
  std::error_code there_is_none;
  std::filesystem::last_write_time(path_, std::filesystem::file_time_type::clock::now(), there_is_none);
}

/// Runs in the other thread. A successor must not continue from half a drive.
void JournalWriter::discard() {
  file_.reset();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  std::filesystem::remove(unfinished(), ignored);
}

void JournalWriter::remove() {
  if (under_way_.valid()) under_way_.wait();
  discard();
}

}  // namespace curbstone::mapper::journal
