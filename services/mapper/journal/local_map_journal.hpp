#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "services/mapper/journal/journal_writer.hpp"
#include "services/mapper/journal/recorded_drive.hpp"
#include "services/mapper/registration/shape_map.hpp"

namespace curbstone::mapper::journal {

/// Keeps the map that scans are registered to in a file of bounded size: all its voxels, and after them those that have
/// changed, twice a second. Once these are too many, another file begins and replaces the first when it is whole. Each
/// call copies a part of what the file lacks, and nothing while the disk is busy. A file that cannot be written begins
/// anew after some seconds: without it a successor rebuilds the map from keyframes. Calls come from one thread.
class LocalMapJournal {
 public:
  LocalMapJournal(std::string path, std::string config_hash)
      : path_(std::move(path)), config_hash_(std::move(config_hash)), writer_(path_, kMaxBytes) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  /// The file that is there is continued if the map is made of it.
  void adopt(const RecordedLocalMap& map) { adopted_bytes_ = map.bytes; }
  /// Writes what the map has and the file lacks. `levels`: of the map in use, which may be another one than before;
  /// `utime`: us, end of the last scan; `now`: us.
  void write(std::span<registration::ShapeLevel* const> levels, std::int32_t epoch, std::int64_t utime,
             std::int64_t now);
  /// Deletes the file. Waits for the disk.
  void remove() { writer_.remove(); }

 private:
  static constexpr std::size_t kMaxBytes = 1'000'000'000;
  [[nodiscard]] bool is_too_large() const;
  void begin(std::span<registration::ShapeLevel* const> levels);

  std::string path_;
  std::string config_hash_;
  JournalWriter writer_;
  std::size_t adopted_bytes_ = 0;  // 0: none
  bool is_begun_ = false;          // a file was begun or continued
  bool is_draining_ = false;       // changes are being written
  std::int32_t epoch_ = 0;
  std::size_t whole_bytes_ = 0;  // of the file when it was first whole; 0: not yet
  std::int64_t written_ = 0;     // us, when it was last complete
  std::int64_t failed_ = 0;      // us; 0: no failure
};

}  // namespace curbstone::mapper::journal
