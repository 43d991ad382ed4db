#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace curbstone::recorder {

/// Keeps some of a disk free by deleting the oldest sessions of its folder: whole ones, and only folders with the name
/// of a session in which nothing is but what a recorder writes. Three are never deleted: the current one, one that
/// another recorder writes (it is locked), and one in which somebody has put a file of another name, "keep" for
/// example.
class FreeSpace {
 public:
  using Measure = std::function<std::int64_t(const std::filesystem::path&)>;

  /// `keep` bytes; 0: nothing is deleted or refused. `measure` gives the free bytes of a folder's disk.
  FreeSpace(std::filesystem::path folder, std::int64_t keep, Measure measure = free_bytes);

  /// Deletes what it may until enough is free. Returns false if that was not enough.
  [[nodiscard]] bool make_room(const std::filesystem::path& current);
  /// The sessions that it deleted in all.
  [[nodiscard]] std::int64_t deleted() const { return deleted_; }
  /// For people: "less than 10.0 GB are free on the disk of ..., and no older session can be deleted".
  [[nodiscard]] std::string why_refused() const;

  /// What the file system gives to who is not root. A disk that cannot be asked has room: writing will show.
  [[nodiscard]] static std::int64_t free_bytes(const std::filesystem::path& folder);

 private:
  std::filesystem::path folder_;
  std::int64_t keep_;
  Measure measure_;
  std::int64_t deleted_ = 0;
};

/// The sessions of a folder that may be deleted, the oldest first.
[[nodiscard]] std::vector<std::filesystem::path> deletable_sessions(const std::filesystem::path& folder,
                                                                    const std::filesystem::path& current);

}  // namespace curbstone::recorder
