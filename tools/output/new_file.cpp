#include "tools/output/new_file.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>
#include <utility>

namespace curbstone::output {

NewFile::NewFile(std::filesystem::path file, bool force) : file_(std::move(file)), part_(file_.string() + ".part") {
  std::error_code ignored;
  const auto there = std::filesystem::status(file_, ignored);
  if (!std::filesystem::exists(there)) return;
  if (std::filesystem::is_directory(there))
    throw std::runtime_error(fmt::format("{}: cannot be written: it is a folder", file_.string()));
  if (!std::filesystem::is_regular_file(there)) {
    part_ = file_;
  } else if (!force) {
    throw std::runtime_error(fmt::format("{}: is there already; --force replaces it", file_.string()));
  }
}

NewFile::~NewFile() {
  std::error_code ignored;
  if (part_ != file_) std::filesystem::remove(part_, ignored);
}

void NewFile::commit() {
  if (part_ == file_) return;
  std::error_code error;
  std::filesystem::rename(part_, file_, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file_.string(), error.message()));
}

}  // namespace curbstone::output
