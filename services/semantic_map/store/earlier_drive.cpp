#include "services/semantic_map/store/earlier_drive.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace curbstone::semantic_map::store {
namespace {

constexpr std::int64_t kFirstPose = 1'000'000;   // us: a corrected drive may begin so much later than it did
constexpr std::int64_t kCorrection = 5'000'000;  // us: MAP_TRAJECTORY comes so soon after its epoch's first pose

}  // namespace

bool EarlierDrive::correct(std::int64_t first_utime) {
  // Two drives may begin within a second of a clock that starts in 1970, but not within a microsecond.
  if (!kept_ || std::abs(first_utime - kept_->first_utime) > (kept_->moved ? kFirstPose : 0)) return false;
  remove_superseded();
  superseded_ = std::move(kept_->superseded);
  remove_superseded();
  superseded_ = std::move(kept_->file);
  kept_.reset();
  return true;
}

void EarlierDrive::remove_superseded() {
  std::error_code ignored;  // it stays, then
  if (!superseded_.empty()) std::filesystem::remove(std::exchange(superseded_, {}), ignored);
}

std::string EarlierDrive::fault(std::int64_t utime) const {
  if (!kept_ || !kept_->moved || utime - *kept_->moved <= kCorrection) return {};
  return fmt::format("the mapper began a new map in mid-drive; what was mapped before is kept in {}", kept_->file);
}

}  // namespace curbstone::semantic_map::store
