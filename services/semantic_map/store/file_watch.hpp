#pragma once

#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace curbstone::semantic_map::store {

/// Notices what others do to the files of an open database: SQLite neither sees it nor says it, and would go on writing
/// into files that no longer have a name, or into the remains of a file that was overwritten.
class FileWatch {
 public:
  enum class Change {
    kNone,
    kDeleted,   ///< the file, its -wal or its -shm has no name any more
    kReplaced,  ///< another file has the name
    kWritten,   ///< somebody else wrote to the file, truncated or touched it
  };

  explicit FileWatch(std::string path) : path_(std::move(path)) {}

  /// Takes the files as they are now, after own writes.
  void remember();
  /// What has happened since.
  [[nodiscard]] Change change() const;
  /// Whether another -wal has the name of this file's.
  [[nodiscard]] bool journal_is_replaced() const;

 private:
  struct Seen {
    dev_t device;
    ino_t inode;
    off_t size;
    timespec written;
  };
  [[nodiscard]] static bool is_same(const Seen& a, const Seen& b) { return a.inode == b.inode && a.device == b.device; }
  [[nodiscard]] static std::optional<Seen> look(const std::string& path);

  std::string path_;
  std::array<std::optional<Seen>, 3> seen_{};  // of the file, -wal, -shm
};

}  // namespace curbstone::semantic_map::store
