#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace curbstone::recorder {

/// Keeps a part of a disk free by deleting the oldest sessions of a folder, by the time of their last message. It
/// deletes whole sessions only, and only folders that have the name of a session and contain nothing but a recorder's
/// files. It never deletes the current session, a session that another recorder is writing (it is locked), or a session
/// that contains a file of another name, "keep" for example.
class FreeSpace {
 public:
  using Measure = std::function<std::int64_t(const std::filesystem::path&)>;

  /// `keep`: bytes; 0: nothing is deleted or refused. `measure` returns the free bytes of a folder's disk.
  FreeSpace(std::filesystem::path folder, std::int64_t keep, Measure measure = free_bytes);

  /// Deletes sessions until enough is free. Returns false if that is not possible.
  [[nodiscard]] bool make_room(const std::filesystem::path& current);
  /// The number of sessions deleted so far.
  [[nodiscard]] std::int64_t deleted() const { return deleted_; }
  /// The reason in words: "less than 10 GB are free on the disk of ..., and no older session can be deleted".
  [[nodiscard]] std::string why_refused() const;

  /// The free space for users other than root. A disk that cannot be queried counts as free: writing will show an
  /// error.
  [[nodiscard]] static std::int64_t free_bytes(const std::filesystem::path& folder);

 private:
  std::filesystem::path folder_;
  std::int64_t keep_;
  Measure measure_;
  std::int64_t deleted_ = 0;
};

/// The sessions of a folder that may be deleted, that which was last written the longest ago first.
[[nodiscard]] std::vector<std::filesystem::path> deletable_sessions(const std::filesystem::path& folder,
                                                                    const std::filesystem::path& current);

}  // namespace curbstone::recorder
