#include "services/recorder/free_space.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <regex>
#include <system_error>
#include <utility>

namespace curbstone::recorder {

namespace fs = std::filesystem;

namespace {

bool is_named_as_session(const fs::path& folder) {
  static const std::regex kName(R"(\d{4}-\d\d-\d\dT\d{6}Z(-\d+)?)");
  return std::regex_match(folder.filename().string(), kName);
}

bool holds_only_a_recording(const fs::path& folder) {
  static const std::regex kOurs(R"(drive-\d{3,}\.lcmlog|config\.yaml(\.part)?)");
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!std::regex_match(it->path().filename().string(), kOurs) || !it->is_regular_file()) return false;
  }
  return !error;
}

/// A session's name is its start, which a clock that was wrong then makes too old: one of 1970 may be the newest.
fs::file_time_type last_written(const fs::path& folder) {
  std::error_code error;
  fs::file_time_type last = fs::last_write_time(folder, error);
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    last = std::max(last, it->last_write_time(ignored));
  }
  return last;
}

bool is_written_now(const fs::path& folder) {
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool free = fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0;
  if (fd >= 0) close(fd);
  return !free;
}

}  // namespace

std::vector<fs::path> deletable_sessions(const fs::path& folder, const fs::path& current) {
  std::vector<std::pair<fs::file_time_type, fs::path>> sessions;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    std::error_code ignored;
    if (it->is_symlink(ignored) || !it->is_directory(ignored) || fs::equivalent(path, current, ignored)) continue;
    if (is_named_as_session(path) && holds_only_a_recording(path) && !is_written_now(path))
      sessions.emplace_back(last_written(path), path);
  }
  std::sort(sessions.begin(), sessions.end());
  std::vector<fs::path> paths;
  for (auto& [time, path] : sessions) paths.push_back(std::move(path));
  return paths;
}

FreeSpace::FreeSpace(fs::path folder, std::int64_t keep, Measure measure)
    : folder_(std::move(folder)), keep_(keep), measure_(std::move(measure)) {}

bool FreeSpace::make_room(const fs::path& current) {
  if (keep_ == 0 || measure_(folder_) >= keep_) return true;
  for (const fs::path& session : deletable_sessions(folder_, current)) {
    std::error_code error;
    fs::remove_all(session, error);
    if (!error) ++deleted_;
    if (measure_(folder_) >= keep_) return true;
  }
  return false;
}

std::string FreeSpace::why_refused() const {
  return fmt::format("less than {:.3g} GB are free on the disk of {}, and no older session can be deleted",
                     static_cast<double>(keep_) * 1e-9, folder_.string());
}

std::int64_t FreeSpace::free_bytes(const fs::path& folder) {
  std::error_code error;
  const auto space = fs::space(folder, error);
  return error ? std::numeric_limits<std::int64_t>::max() : static_cast<std::int64_t>(space.available);
}

}  // namespace curbstone::recorder
