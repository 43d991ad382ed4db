#include "services/mapper/journal/journal_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "services/mapper/journal/recorded_drive.hpp"

namespace curbstone::mapper::journal {

JournalLock::JournalLock(const std::string& path) {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  file_ = open((path + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0 || flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(file_);
  throw JournalError(fmt::format("{}: another mapper keeps it; stop that one, or use another file", path));
}

JournalLock::~JournalLock() {
  if (file_ >= 0) close(file_);
}

}  // namespace curbstone::mapper::journal
