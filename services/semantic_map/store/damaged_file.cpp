#include "services/semantic_map/store/damaged_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "common/time/dated_path.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::semantic_map::store {

std::string set_damaged_aside(const std::string& path) {
  struct stat there {};
  stat(path.c_str(), &there);
  const std::filesystem::path file(path);
  std::string aside = free_dated_path((file.parent_path() / file.stem()).string() + "-damaged",
                                      std::int64_t{there.st_mtim.tv_sec} * 1'000'000, file.extension().string());
  std::error_code error;
  std::filesystem::rename(path, aside, error);
  if (error) throw MapStoreError(fmt::format("{}: is damaged, and cannot be renamed: {}", path, error.message()));
  for (const char* part : {"-wal", "-shm"}) std::filesystem::rename(path + part, aside + part, error);
  return aside;
}

}  // namespace curbstone::semantic_map::store
