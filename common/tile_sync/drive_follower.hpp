#pragma once

#include <cstddef>
#include <cstdint>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/tile_sync/drive_pages.hpp"
#include "common/tile_sync/tile_sync.hpp"

namespace curbstone {

/// A listener's side of the drive (drive_pages.hpp): which poses of an epoch it has, and which pages it lacks in part.
/// Pure; one thread.
class DriveFollower {
 public:
  static constexpr std::size_t kMaxPoses = 2'000'000;  ///< a day at 20 Hz, 16 MB; further poses are ignored
  static constexpr std::size_t kMaxBehind = 20'000;    ///< pages: two days
  static constexpr std::size_t kPagesAtOnce = 4;       ///< asked for in one request

  explicit DriveFollower(std::string requester) : pages_(std::move(requester), kDriveChannel) {}

  void start_epoch(std::int32_t epoch);
  /// Takes the stamp of a received pose, us. Returns false if it is a duplicate or there are too many.
  bool add(std::int64_t utime);
  /// Takes an index page of any channel.
  void announced(const tile_index_t& message);
  /// The request for missing pages; num_tiles is 0 if nothing is to be asked. `now`: message time, us.
  [[nodiscard]] tile_request_t make_request(std::int64_t now);
  /// The number of pages of which poses are missing.
  [[nodiscard]] std::size_t behind() const { return pages_.behind(); }
  /// A fault in words while poses are missing that were asked for: others may be on their way.
  [[nodiscard]] std::optional<std::string> fault() const;

 private:
  TileFollower pages_;
  std::unordered_map<TileKey, std::vector<std::int64_t>, TileKeyHash> poses_;  // stamps, sorted, us
  std::size_t num_poses_ = 0;
  bool has_asked_ = false;  // since it last had all poses
};

}  // namespace curbstone
