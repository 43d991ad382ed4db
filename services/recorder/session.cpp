#include "services/recorder/session.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace curbstone::recorder {

namespace fs = std::filesystem;

namespace {

std::string utc_name(std::int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  (void)std::strftime(text, sizeof text, "%Y-%m-%dT%H%M%SZ", &utc);
  return text;
}

}  // namespace

Session::Session(const fs::path& folder, std::int64_t utime) {
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::path first = folder / utc_name(utime);
  path_ = first;
  for (int n = 2; !error && !fs::create_directory(path_, error); ++n) path_ = fmt::format("{}-{}", first.string(), n);
  if (error) throw std::system_error(error, path_.string() + ": cannot be made");
  lock();
}

void Session::lock() {
  if (lock_ >= 0) close(lock_);
  lock_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ >= 0) (void)flock(lock_, LOCK_EX | LOCK_NB);
}

Session::~Session() {
  if (lock_ >= 0) close(lock_);
  std::error_code ignored;
  fs::remove(path_, ignored);  // only if it is empty
}

std::string Session::next_log() {
  std::error_code error;
  if (fs::create_directories(path_, error)) lock();
  if (error) throw std::runtime_error(fmt::format("{}: cannot be made: {}", path_.string(), error.message()));
  for (int n = 0;; ++n) {
    const fs::path log = path_ / fmt::format("drive-{:03}.lcmlog", n);
    if (!fs::exists(log)) return log.string();
  }
}

void Session::write_config(const std::string& yaml) const {
  const fs::path part = path_ / "config.yaml.part";
  std::error_code ignored;
  if (std::ofstream(part) << yaml << std::flush) {
    fs::rename(part, path_ / "config.yaml", ignored);
  } else {
    fs::remove(part, ignored);
  }
}

}  // namespace curbstone::recorder
