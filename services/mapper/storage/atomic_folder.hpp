#pragma once

#include <filesystem>

namespace curbstone::mapper::storage {

/// A folder that is written under a temporary name and put in place in one step. All functions throw MapFolderError.
class AtomicFolder {
 public:
  /// `is_ours`: whether a folder contains only what may be replaced; other folders are left alone. Remains of an
  /// earlier attempt are removed.
  AtomicFolder(const std::filesystem::path& folder, bool (*is_ours)(const std::filesystem::path& folder));
  /// Removes the temporary folder if it was not committed.
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// The folder that will be replaced, with links resolved; it need not exist.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// The temporary folder, to write to.
  [[nodiscard]] const std::filesystem::path& partial() const { return partial_; }
  /// Syncs all that was written to the disk, puts the new folder in place, then removes the old one.
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path partial_;
};

}  // namespace curbstone::mapper::storage
