#include "services/mapper/storage/map_saver.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>

#include "common/time/dated_path.hpp"
#include "common/time/microseconds.hpp"

namespace curbstone::mapper::storage {
namespace fs = std::filesystem;

bool MapSaver::busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  finish();
  return false;
}

void MapSaver::begin_epoch(std::int32_t epoch) {
  if (!loaded_) return;
  on_disk_ = *std::exchange(loaded_, std::nullopt);
  on_disk_.epoch = epoch;
  is_of_loaded_map_ = true;
}

bool MapSaver::is_due(std::int64_t utime) {
  if (save_every_ <= 0) return false;
  if (period_began_ == 0) period_began_ = utime;
  return !busy() && std::abs(utime - period_began_) >= microseconds(save_every_);
}

void MapSaver::begin(MapSnapshot snapshot) {
  if (snapshot.versions == on_disk_ && fault_.empty() && !is_of_loaded_map_) return;
  is_of_loaded_map_ = false;
  under_way_ = std::move(snapshot.versions);
  writing_ = std::async(std::launch::async, [map = std::move(snapshot.map), folder = folder_]() -> Result {
    try {
      return {{}, save_map(map, folder)};
    } catch (const std::exception& error) {
      return {error.what(), {}};
    }
  });
}

/// If the snapshot cannot be written, the folder is set aside as it is.
fs::path MapSaver::set_aside(MapSnapshot last, std::int64_t began) {
  std::error_code ignored;
  const fs::path folder = fs::weakly_canonical(folder_, ignored);
  const fs::path beside = free_dated_path(folder.string(), began);
  is_of_loaded_map_ = false;
  is_last_ = true;
  period_began_ = 0;
  writing_ = std::async(std::launch::async, [map = std::move(last.map), folder, beside]() -> Result {
    Result result;
    try {
      result.missing = save_map(map, folder);
    } catch (const std::exception& error) {
      result.fault = error.what();
    }
    std::error_code error;
    if (fs::exists(folder, error)) fs::rename(folder, beside, error);
    if (error && result.fault.empty()) result.fault = fmt::format("{}: {}", beside.string(), error.message());
    return result;
  });
  return beside;
}

void MapSaver::finish() {
  if (!writing_.valid()) return;
  const Result result = writing_.get();
  fault_ = result.fault;
  counters_.add(fault_.empty() ? "folder.saved" : "faults.folder");
  if (std::exchange(is_last_, false) || !fault_.empty()) {
    on_disk_ = {};
    return;
  }
  forget(result.missing);
  on_disk_ = std::move(under_way_);
}

/// What the saved snapshot lacks is written again with the next one.
void MapSaver::forget(const MissingParts& missing) {
  if (missing.size() == 0) return;
  for (const TileKey& key : missing.gone) under_way_.tiles.erase(key);
  for (const TileKey& key : missing.earlier) under_way_.tiles[key] = on_disk_.tiles.at(key);
  for (const std::size_t i : missing.keyframes) under_way_.nodes[i].points = 0;
  counters_.add("folder.left_out", static_cast<std::int64_t>(missing.size()));
  fault_ = fmt::format(
      "{}: saved without {} tiles and the scans of {} keyframes, and with {} tiles as they were before: "
      "the disk of far_folder does not give them back",
      folder_.string(), missing.gone.size(), missing.keyframes.size(), missing.earlier.size());
}

}  // namespace curbstone::mapper::storage
