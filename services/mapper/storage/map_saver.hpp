#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <utility>

#include "common/bus/counters.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_snapshot.hpp"

namespace curbstone::mapper::storage {

/// Writes a map to its folder again and again, beside its owner: only files that are not there yet, and so that the
/// folder holds a whole map at any time (save_map()). What cannot be written is counted and said; the next time all of
/// it is tried anew. So is what the file of far tiles does not give back: the rest is saved. One thread calls; the
/// writing is in another.
///
/// Counters: folder.saved, folder.left_out (tiles and scans of keyframes), faults.folder.
class MapSaver {
 public:
  explicit MapSaver(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Waits for what is under way.
  ~MapSaver() { finish(); }
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  /// Whether a snapshot is still being written.
  [[nodiscard]] bool busy();
  /// A map that was loaded from there: of its files those that it is told of are good. Before the first snapshot, which
  /// is written in any case.
  void holds(MapVersions versions) {
    on_disk_ = std::move(versions);
    is_of_another_ = true;
  }
  /// What the folder holds; nothing is known of it before the first snapshot. Not while busy.
  [[nodiscard]] const MapVersions& on_disk() const { return on_disk_; }
  /// Takes what was made against on_disk(); one that has nothing new is not written. Not while busy.
  void begin(MapSnapshot snapshot);
  /// The last one of a drive that another follows: it is written, and the folder then renamed to what this returns,
  /// with the UTC of `began`, us, in its name. Not while busy.
  std::filesystem::path set_aside(MapSnapshot last, std::int64_t began);
  /// Waits until it is written.
  void finish();

  /// What is wrong with the last snapshot: it could not be written, or not all of it; empty: nothing.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  std::filesystem::path folder_;
  MapVersions on_disk_;
  MapVersions under_way_;
  struct Result {
    std::string fault;  // nothing has been written; empty: it has
    LeftOut left_out;
  };
  void forget(const LeftOut& left_out);
  bool is_of_another_ = false;  // whose epoch its head names
  bool is_last_ = false;        // what is under way is set aside then
  std::future<Result> writing_;
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone::mapper::storage
