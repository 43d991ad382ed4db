#include "common/tile_sync/drive_follower.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone {

void DriveFollower::start_epoch(std::int32_t epoch) {
  pages_.start_epoch(epoch);
  poses_.clear();
  num_poses_ = 0;
}

bool DriveFollower::add(std::int64_t utime) {
  if (num_poses_ >= kMaxPoses) return false;
  const TileKey key = drive_page(utime);
  std::vector<std::int64_t>& page = poses_[key];
  const auto at = std::lower_bound(page.begin(), page.end(), utime);
  if ((at != page.end() && *at == utime) || page.size() >= kMaxPosesPerPage) return false;
  page.insert(at, utime);
  ++num_poses_;
  pages_.set_have(key, static_cast<std::int32_t>(page.size()));
  return true;
}

void DriveFollower::announced(const tile_index_t& message) {
  if (pages_.behind() < kMaxBehind && num_poses_ < kMaxPoses) pages_.announced(message);
}

tile_request_t DriveFollower::make_request(std::int64_t now) {
  tile_request_t request = pages_.make_request(now, kPagesAtOnce);
  has_asked_ = pages_.behind() > 0 && (has_asked_ || request.num_tiles > 0);
  return request;
}

std::optional<std::string> DriveFollower::fault() const {
  if (pages_.behind() == 0 || !has_asked_) return std::nullopt;
  return fmt::format("poses of the drive are missing, in {} pages of 10 s: they are asked for again", pages_.behind());
}

}  // namespace curbstone
