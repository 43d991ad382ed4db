#include "services/semantic_map/store/damaged_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "common/time/dated_path.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::semantic_map::store {

namespace {

/// `what`: damaged, replaced.
std::string set_aside(const std::string& path, const std::string& what) {
  struct stat there {};
  stat(path.c_str(), &there);
  const std::filesystem::path file(path);
  std::string aside = free_dated_path((file.parent_path() / file.stem()).string() + "-" + what,
                                      std::int64_t{there.st_mtim.tv_sec} * 1'000'000, file.extension().string());
  std::error_code error;
  std::filesystem::rename(path, aside, error);
  if (error) throw MapStoreError(fmt::format("{}: is {}, and cannot be renamed: {}", path, what, error.message()));
  return aside;
}

}  // namespace

std::string set_damaged_aside(const std::string& path) {
  std::string aside = set_aside(path, "damaged");
  std::error_code error;
  for (const char* part : {"-wal", "-shm"}) std::filesystem::rename(path + part, aside + part, error);
  return aside;
}

std::string set_replacement_aside(const std::string& path, bool with_journal) {
  std::string aside = set_aside(path, "replaced");
  std::error_code error;
  if (with_journal) std::filesystem::rename(path + "-wal", aside + "-wal", error);
  return aside;
}

}  // namespace curbstone::semantic_map::store
