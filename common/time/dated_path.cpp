#include "common/time/dated_path.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <system_error>

namespace curbstone {

std::string free_dated_path(const std::string& stem, std::int64_t utime, const std::string& extension) {
  const std::time_t second = utime / 1'000'000;
  const std::string dated = fmt::format("{}-{:%Y%m%dT%H%M%SZ}", stem, fmt::gmtime(second));
  std::string path = dated + extension;
  std::error_code ignored;
  for (int i = 2; std::filesystem::exists(path, ignored); ++i) path = fmt::format("{}-{}{}", dated, i, extension);
  return path;
}

}  // namespace curbstone
