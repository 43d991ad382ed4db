#include "tools/replay/new_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace curbstone::replay {

namespace fs = std::filesystem;

namespace {

void refuse_what_is_no_map(const fs::path& file) {
  std::error_code ignored;
  const auto there = fs::status(file, ignored);
  if (!fs::exists(there)) return;
  if (!fs::is_regular_file(there))
    throw std::runtime_error(fmt::format("--map {}: a map must be a file", file.string()));
  constexpr std::string_view kMagic = "SQLite format 3";
  std::string begin(kMagic.size(), ' ');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (in.gcount() > 0 && begin != kMagic)
    throw std::runtime_error(fmt::format("--map {}: is there, and is no map: it is not replaced", file.string()));
}

void remove_beside(const fs::path& file) {
  for (const char* suffix : {"-wal", "-shm"}) std::remove((file.string() + suffix).c_str());
}

}  // namespace

NewMap::NewMap(fs::path file)
    : file_((refuse_what_is_no_map(file), std::move(file))), folder_(file_.string() + ".part") {
  clear();  // of an earlier replay that was killed
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file_.string(), error.message()));
}

NewMap::~NewMap() {
  clear();
}

/// Removes only what a replay creates there: maps, and the files that SQLite keeps beside them.
void NewMap::clear() const {
  std::error_code ignored;
  const std::string stem = file_.stem().string();
  for (fs::directory_iterator it(folder_, ignored), end; it != end; it.increment(ignored)) {
    if (it->path().filename().string().starts_with(stem)) fs::remove(it->path(), ignored);
  }
  fs::remove(folder_, ignored);
}

std::string NewMap::with_final_names(std::string text) const {
  const std::string part = folder_.string() + "/";
  const fs::path parent = file_.parent_path();
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at))
    text.replace(at, part.size(), parent.empty() ? "" : (parent / "").string());
  return text;
}

std::vector<std::string> NewMap::commit() {
  std::vector<std::string> earlier;
  const auto give_name = [&](const fs::path& part, const fs::path& file) {
    refuse_what_is_no_map(file);
    remove_beside(part);
    remove_beside(file);
    std::error_code error;
    fs::rename(part, file, error);
    if (error) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
  };
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const fs::path name = entry.path().filename();
    if (name == file_.filename() || name.extension() != file_.extension()) continue;
    earlier.push_back((file_.parent_path() / name).string());
  }
  std::sort(earlier.begin(), earlier.end());
  for (const std::string& file : earlier) give_name(folder_ / fs::path(file).filename(), file);
  give_name(part(), file_);
  return earlier;
}

}  // namespace curbstone::replay
