#include "tools/replay/new_map.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace curbstone::replay {

namespace {

void refuse_what_is_no_map(const std::string& file) {
  std::error_code ignored;
  const auto there = std::filesystem::status(file, ignored);
  if (!std::filesystem::exists(there)) return;
  if (!std::filesystem::is_regular_file(there))
    throw std::runtime_error(fmt::format("--map {}: a map must be a file", file));
  constexpr std::string_view kMagic = "SQLite format 3";
  std::string begin(kMagic.size(), ' ');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (in.gcount() > 0 && begin != kMagic)
    throw std::runtime_error(fmt::format("--map {}: is there, and is no map: it is not replaced", file));
}

void remove_beside(const std::string& file) {
  for (const char* suffix : {"-wal", "-shm"}) std::remove((file + suffix).c_str());
}

}  // namespace

NewMap::NewMap(std::string file) : file_((refuse_what_is_no_map(file), std::move(file))), whole_(file_, true) {
  std::remove(part().c_str());  // of an earlier replay that was killed
  remove_beside(part());
}

NewMap::~NewMap() {
  remove_beside(part());
}

void NewMap::commit() {
  remove_beside(file_);
  whole_.commit();
}

}  // namespace curbstone::replay
