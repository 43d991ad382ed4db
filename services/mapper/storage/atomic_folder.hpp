#pragma once

#include <filesystem>

namespace curbstone::mapper::storage {

/// A folder that is written beside its name and takes its place in one step. Everything throws MapFolderError.
class AtomicFolder {
 public:
  /// `is_ours`: whether a folder holds nothing but what may be replaced; others are left alone. What an earlier attempt
  /// left is removed.
  AtomicFolder(const std::filesystem::path& folder, bool (*is_ours)(const std::filesystem::path& folder));
  /// Nothing half-written stays.
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// What will be replaced, links followed; need not exist.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Where to write.
  [[nodiscard]] const std::filesystem::path& partial() const { return partial_; }
  /// All that was written is on the disk; then it takes its place; then what was there goes.
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path partial_;
};

}  // namespace curbstone::mapper::storage
