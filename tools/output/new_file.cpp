#include "tools/output/new_file.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>
#include <utility>

namespace curbstone::output {

NewFile::NewFile(std::filesystem::path file, bool force) : file_(std::move(file)), part_(file_.string() + ".part") {
  if (!force && std::filesystem::exists(file_))
    throw std::runtime_error(fmt::format("{}: is there already; --force replaces it", file_.string()));
}

NewFile::~NewFile() {
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void NewFile::commit() {
  std::error_code error;
  std::filesystem::rename(part_, file_, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file_.string(), error.message()));
}

}  // namespace curbstone::output
