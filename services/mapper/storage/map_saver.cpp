#include "services/mapper/storage/map_saver.hpp"

#include <chrono>
#include <utility>

#include "services/mapper/storage/map_folder.hpp"

namespace curbstone::mapper::storage {

bool MapSaver::busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  finish();
  return false;
}

void MapSaver::begin(MapSnapshot snapshot) {
  if (snapshot.versions == on_disk_ && fault_.empty()) return;
  under_way_ = std::move(snapshot.versions);
  writing_ = std::async(std::launch::async, [map = std::move(snapshot.map), folder = folder_]() -> std::string {
    try {
      save_map(map, folder);
      return {};
    } catch (const std::exception& error) {
      return error.what();
    }
  });
}

void MapSaver::finish() {
  if (!writing_.valid()) return;
  fault_ = writing_.get();
  counters_.add(fault_.empty() ? "folder.saved" : "faults.folder");
  on_disk_ = fault_.empty() ? std::move(under_way_) : MapVersions{};
}

}  // namespace curbstone::mapper::storage
