#include "services/semantic_map/store/file_watch.hpp"

#include <cstddef>

namespace curbstone::semantic_map::store {

namespace {

constexpr std::array<const char*, 3> kParts = {"", "-wal", "-shm"};

}  // namespace

std::optional<FileWatch::Seen> FileWatch::look(const std::string& path) {
  struct stat there {};
  if (stat(path.c_str(), &there) != 0) return std::nullopt;
  return Seen{there.st_dev, there.st_ino, there.st_size, there.st_mtim};
}

void FileWatch::remember() {
  for (std::size_t i = 0; i < kParts.size(); ++i) seen_[i] = look(path_ + kParts[i]);
}

bool FileWatch::journal_is_replaced() const {
  const auto there = look(path_ + "-wal");
  return there && !(seen_[1] && is_same(*there, *seen_[1]));
}

FileWatch::Change FileWatch::change() const {
  const auto there = look(path_);
  if (!there) return Change::kDeleted;
  if (seen_[0] && !is_same(*there, *seen_[0])) return Change::kReplaced;
  for (std::size_t i = 1; i < kParts.size(); ++i) {
    const auto part = look(path_ + kParts[i]);
    if (seen_[i] && (!part || !is_same(*part, *seen_[i]))) return Change::kDeleted;
  }
  const bool was_written =
      seen_[0] && (there->size != seen_[0]->size || there->written.tv_sec != seen_[0]->written.tv_sec ||
                   there->written.tv_nsec != seen_[0]->written.tv_nsec);
  return was_written ? Change::kWritten : Change::kNone;
}

}  // namespace curbstone::semantic_map::store
