// A journal, and the local map beside one: batches of items that a mapper may have written. The checksums are right, as
// a wrong one ends it at once.
#include <utility>

#include "common/packing/spill_file.hpp"
#include "services/mapper/journal/journal_file.hpp"
#include "services/mapper/journal/local_map_file.hpp"
#include "services/mapper/mapper.hpp"
#include "tests/fuzz/support/memory_file.hpp"

namespace {

using namespace curbstone;
using mapper::journal::RecordedDrive;

constexpr std::size_t kMaxBytes = 1'000'000;
constexpr std::size_t kMaxNodes = 4;  // to go on with: a map of more takes longer than all else

std::optional<RecordedDrive> read(const fuzz::MemoryFile& file, SpillFile* far) {
  try {
    return mapper::journal::read_journal(file.name(), kMaxBytes, "", far);
  } catch (const mapper::journal::JournalError&) {
    return std::nullopt;
  }
}

std::string journal_of(fuzz::Input input) {
  std::string journal;
  while (!input.empty()) journal += mapper::journal::make_batch(fuzz::text(input.piece()));
  return journal;
}

void read_as_local_map(const fuzz::MemoryFile& file, std::size_t bytes) {
  const auto map = mapper::journal::read_local_map(file.name(), "", 0);
  if (!map) return;
  std::size_t voxels = 0;
  for (const auto& level : map->levels) voxels += level.size();
  fuzz::require(map->bytes <= bytes && voxels * sizeof(mapper::registration::VoxelSums) <= bytes,
                "no voxel is made up");
  for (const auto& level : map->levels) {
    mapper::registration::ShapeLevel shapes(mapper::registration::ShapeLevelOptions{});
    shapes.restore(level);
    fuzz::require(shapes.size() <= level.size(), "a voxel that comes twice is one");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = journal_of(fuzz::Input(data, size));
  const fuzz::MemoryFile file({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  read_as_local_map(file, bytes.size());
  std::optional<RecordedDrive> drive = read(file, nullptr);
  SpillFile far;
  const std::optional<RecordedDrive> packed = read(file, &far);
  fuzz::require(drive.has_value() == packed.has_value(), "the same wherever far tiles lie");
  if (!drive) return 0;
  fuzz::require(drive->tiles.size() == packed->tiles.size() && drive->poses.size() == packed->poses.size(),
                "as much wherever far tiles lie");
  std::size_t records = 0;
  for (const auto& [key, tile] : drive->tiles) records += tile.content.records.size();
  fuzz::require(records <= bytes.size(), "no point is made up");
  if (drive->nodes.size() > kMaxNodes) return 0;
  mapper::config::MapperConfig config;
  config.threads = 1;
  mapper::Mapper successor(config);
  successor.resume(std::move(*drive));
  mapper::scan::Scan scan;
  scan.start = packed->poses.back().utime;
  scan.end = scan.start + 50'000;
  (void)successor.process(scan, {});
  (void)successor.finish();
  return 0;
}
