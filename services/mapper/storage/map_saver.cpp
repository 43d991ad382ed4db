#include "services/mapper/storage/map_saver.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace curbstone::mapper::storage {

bool MapSaver::busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  finish();
  return false;
}

void MapSaver::begin(MapSnapshot snapshot) {
  if (snapshot.versions == on_disk_ && fault_.empty() && !is_of_another_) return;
  is_of_another_ = false;
  under_way_ = std::move(snapshot.versions);
  writing_ = std::async(std::launch::async, [map = std::move(snapshot.map), folder = folder_]() -> Result {
    try {
      return {{}, save_map(map, folder)};
    } catch (const std::exception& error) {
      return {error.what(), {}};
    }
  });
}

void MapSaver::finish() {
  if (!writing_.valid()) return;
  const Result result = writing_.get();
  fault_ = result.fault;
  counters_.add(fault_.empty() ? "folder.saved" : "faults.folder");
  if (!fault_.empty()) {
    on_disk_ = {};
    return;
  }
  forget(result.left_out);
  on_disk_ = std::move(under_way_);
}

/// What it lacks is new to the folder the next time.
void MapSaver::forget(const LeftOut& left_out) {
  if (left_out.size() == 0) return;
  for (const TileKey& key : left_out.gone) under_way_.tiles.erase(key);
  for (const TileKey& key : left_out.earlier) under_way_.tiles[key] = on_disk_.tiles.at(key);
  for (const std::size_t i : left_out.keyframes) under_way_.nodes[i].points = 0;
  counters_.add("folder.left_out", static_cast<std::int64_t>(left_out.size()));
  fault_ = fmt::format(
      "{}: saved without {} tiles and the scans of {} keyframes, and with {} tiles as they were before: "
      "the disk of far_folder does not give them back",
      folder_.string(), left_out.gone.size(), left_out.keyframes.size(), left_out.earlier.size());
}

}  // namespace curbstone::mapper::storage
