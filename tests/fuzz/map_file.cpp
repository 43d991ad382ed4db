// A map of semantic_map in which some values, or some bytes of the file, are others.
#include <SQLiteCpp/SQLiteCpp.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "services/semantic_map/store/map_store.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace {

namespace fs = std::filesystem;
using namespace curbstone;
using namespace curbstone::semantic_map;

/// In memory: a disk would be waited for.
std::string map_file() {
  return "/dev/shm/fuzz_map_file-" + std::to_string(getpid()) + ".db";
}

std::string good_map() {
  const std::vector<tile::CurbLine> curbs = {{0, 0.5F, false, {{1, 2, 0, 0.1F, 0, 1}, {2, 2, 0, 0.1F, 0, 1}}}};
  const std::vector<tile::MarkingLine> markings = {
      {.id = 0, .type = tile::MarkingType::kSolid, .points = {{0, 0, 0, true}, {3, 0, 0, false}}}};
  tile::MapTile one;
  one.key = {1, -2};
  one.utime = 1'000'000;
  fs::remove(map_file());
  {
    store::MapStore store(map_file());
    store.write({.epoch = 7,
                 .tiles = {one},
                 .trajectory = {{1'000'000, 1, Pose::Identity()}},
                 .curbs = &curbs,
                 .markings = &markings});
    store.close_canonical();
  }
  std::ifstream file(map_file(), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr std::array kColumns = {
    "tiles SET x",         "tiles SET y",        "tiles SET utime",          "tiles SET z_origin",
    "tiles SET cells",     "curbs SET id",       "curbs SET confidence",     "curbs SET dropped",
    "curbs SET points",    "curbs SET inferred", "markings SET type",        "markings SET width",
    "markings SET points", "trajectory SET x",   "trajectory SET qw",        "trajectory SET utime",
    "meta SET value",      "meta SET key",       "trajectory SET revolution"};

void set_values(fuzz::Input& input) {
  SQLite::Database db(map_file(), SQLite::OPEN_READWRITE);
  while (!input.empty()) {
    const std::size_t column = input.number<std::uint8_t>() % kColumns.size();
    SQLite::Statement update(db, std::string("UPDATE ") + kColumns[column] + " = ?");
    switch (input.number<std::uint8_t>() % 4) {
      case 0:
        update.bind(1, input.number<std::int64_t>());
        break;
      case 1:
        update.bind(1, input.number<double>());
        break;
      case 2: {
        const fuzz::Bytes bytes = input.piece();
        update.bind(1, bytes.data(), static_cast<int>(bytes.size()));
        break;
      }
      default:
        update.bind(1, std::string(fuzz::text(input.piece())));
    }
    update.exec();
  }
}

void change_bytes(fuzz::Input& input, std::string bytes) {
  while (!input.empty()) {
    const std::size_t at = input.number<std::uint32_t>() % bytes.size();
    for (std::size_t i = 0; const std::uint8_t byte : input.piece()) {
      if (at + i < bytes.size()) bytes[at + i] = static_cast<char>(byte);
      ++i;
    }
  }
  std::ofstream(map_file(), std::ios::binary) << bytes;
}

bool is_finite(float value) {
  return std::isfinite(value);
}

void read_all() {
  const store::MapReader map(map_file());
  (void)map.epoch();
  for (const tile::MapTile& tile : map.tiles()) {
    fuzz::require(std::abs(tile.key.x) <= 1'000'000 && std::abs(tile.key.y) <= 1'000'000, "a tile lies on the earth");
    fuzz::require(is_finite(tile.z_origin), "a tile has a height");
    for (const tile::CellClass c : tile.cell_class)
      fuzz::require(static_cast<int>(c) < tile::kNumClasses, "a cell has a class");
  }
  for (const tile::CurbLine& line : map.curbs()) {
    fuzz::require(line.confidence >= 0 && line.confidence <= 1, "a curb has a confidence");
    for (const auto& p : line.points)
      fuzz::require(is_finite(p.x) && is_finite(p.y) && is_finite(p.z) && is_finite(p.height), "a curb is somewhere");
  }
  for (const tile::MarkingLine& line : map.markings())
    for (const auto& p : line.points) fuzz::require(is_finite(p.x) && is_finite(p.y), "a marking is somewhere");
  for (const auto& pose : map.trajectory()) fuzz::require(curbstone::is_finite(pose.T_map_base), "a pose is one");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string good = good_map();
  fuzz::Input input(data, size);
  try {
    if (input.number<std::uint8_t>() % 2 == 0) {
      std::ofstream(map_file(), std::ios::binary) << good;
      set_values(input);
    } else {
      change_bytes(input, good);
    }
  } catch (const SQLite::Exception&) {
    // A value that the table does not take.
  }
  try {
    read_all();
  } catch (const store::MapStoreError&) {
    // No map, and said so.
  }
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(map_file() + suffix);
  return 0;
}
