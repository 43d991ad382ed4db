#include "services/mapper/journal/local_map_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "services/mapper/journal/batch_bytes.hpp"
#include "services/mapper/journal/journal_file.hpp"

namespace curbstone::mapper::journal {
namespace {

using registration::VoxelSums;

constexpr std::size_t kMaxBytes = 1'000'000'000;
constexpr std::uint32_t kMaxLevels = 8;
constexpr std::int32_t kMaxCell = 1 << 20;  // along an axis: what a voxel's key can name

static_assert(std::is_trivially_copyable_v<VoxelSums> && sizeof(VoxelSums) == 16 * 4);

void require_of_map(bool holds) {
  if (!holds) throw std::runtime_error("is no local map");
}

bool is_possible(const VoxelSums& voxel) {
  return std::all_of(voxel.cell.begin(), voxel.cell.end(),
                     [](std::int32_t v) { return v > -kMaxCell && v < kMaxCell; }) &&
         std::all_of(voxel.sums.begin(), voxel.sums.end(), [](float v) { return std::isfinite(v); }) &&
         voxel.sums[0] >= 0;
}

LocalMapPart decoded(const std::string& items) {
  BatchBytes bytes(items);
  LocalMapPart part;
  part.config_hash = bytes.take_bytes(bytes.take<std::uint32_t>());
  part.epoch = bytes.take<std::int32_t>();
  part.utime = bytes.take<std::int64_t>();
  const auto levels = bytes.take<std::uint32_t>();
  require_of_map(levels <= kMaxLevels);
  for (std::uint32_t i = 0; i < levels; ++i) {
    const auto count = bytes.take<std::uint32_t>();
    const std::string_view voxels = bytes.take_bytes(std::size_t{count} * sizeof(VoxelSums));
    std::vector<VoxelSums>& level = part.levels.emplace_back(count);
    if (count > 0) std::memcpy(level.data(), voxels.data(), voxels.size());
    require_of_map(std::all_of(level.begin(), level.end(), is_possible));
  }
  require_of_map(bytes.empty());
  return part;
}

}  // namespace

std::string encoded(const LocalMapPart& part) {
  std::string out;
  append_value(out, static_cast<std::uint32_t>(part.config_hash.size()));
  out += part.config_hash;
  append_value(out, part.epoch);
  append_value(out, part.utime);
  append_value(out, static_cast<std::uint32_t>(part.levels.size()));
  for (const std::vector<VoxelSums>& level : part.levels) {
    append_value(out, static_cast<std::uint32_t>(level.size()));
    out.append(reinterpret_cast<const char*>(level.data()), level.size() * sizeof(VoxelSums));
  }
  return out;
}

std::optional<RecordedLocalMap> read_local_map(const std::string& path, const std::string& config_hash,
                                               std::int32_t epoch) {
  RecordedLocalMap map;
  std::int32_t last_epoch = 0;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  try {
    map.bytes = read_batches(path, kMaxBytes, [&](const std::string& items) {
      const LocalMapPart part = decoded(items);
      map.levels.resize(std::max(map.levels.size(), part.levels.size()));
      require_of_map(part.config_hash == config_hash && part.levels.size() == map.levels.size());
      for (std::size_t i = 0; i < part.levels.size(); ++i)
        map.levels[i].insert(map.levels[i].end(), part.levels[i].begin(), part.levels[i].end());
      last_epoch = part.epoch;
      if (part.utime != 0) map.utime = part.utime;
    });
  } catch (const std::exception&) {
    return std::nullopt;
  }
  if (map.utime == 0 || last_epoch != epoch) return std::nullopt;
  return map;
}

}  // namespace curbstone::mapper::journal
