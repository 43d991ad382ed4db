#include "services/mapper/storage/atomic_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

namespace fs = std::filesystem;

namespace {

/// Syncs the folder's file system: one call for thousands of small files.
void sync_to_disk(const fs::path& folder) {
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool done = fd >= 0 && syncfs(fd) == 0;
  const int why = errno;
  if (fd >= 0) close(fd);
  if (!done) throw MapFolderError(fmt::format("{}: cannot be written: {}", folder.string(), std::strerror(why)));
}

/// The target of a name, with links resolved and without a trailing slash; it need not exist.
fs::path resolved(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(folder), error);
  if (error) throw MapFolderError(fmt::format("{}: {}", folder.string(), error.message()));
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

AtomicFolder::AtomicFolder(const fs::path& folder, bool (*is_ours)(const fs::path& folder))
    : folder_(resolved(folder)), partial_(folder_.string() + ".partial") {
  std::error_code error;
  for (const fs::path& path : {folder_, partial_}) {
    if (fs::exists(fs::symlink_status(path, error)) && !is_ours(path))
      throw MapFolderError(fmt::format("{}: holds something else than a map: it is left alone", path.string()));
  }
  fs::remove_all(partial_, error);
  if (!error) fs::create_directories(partial_, error);
  if (error) throw MapFolderError(fmt::format("{}: cannot be written: {}", partial_.string(), error.message()));
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

void AtomicFolder::commit() {
  sync_to_disk(partial_);
  std::error_code error;
  // An exchange, as a non-empty folder cannot be replaced by renaming. The old folder is then the partial one.
  const bool exchange = fs::exists(folder_, error);
  if (renameat2(AT_FDCWD, partial_.c_str(), AT_FDCWD, folder_.c_str(), exchange ? RENAME_EXCHANGE : 0) != 0)
    throw MapFolderError(fmt::format("{}: cannot be replaced: {}", folder_.string(), std::strerror(errno)));
  sync_to_disk(folder_.parent_path());
}

}  // namespace curbstone::mapper::storage
