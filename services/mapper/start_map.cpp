#include "services/mapper/start_map.hpp"

#include <utility>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper {
namespace {

constexpr double kShows = 0.5;  // s of standstill; a shorter one may be a drive that begins slowly

}  // namespace

StartMap::StartMap(const config::DenseConfig& config, const Pose& T_base_lidar, bool threaded,
                   std::shared_ptr<SpillFile> spill_file)
    : config_(config), T_base_lidar_(T_base_lidar), threaded_(threaded), spill_file_(std::move(spill_file)) {}

bool StartMap::takes(const Standstill& standstill, std::int64_t utime) const {
  return !is_over_ && !standstill.has_moved && scan::seconds(standstill.began, utime) <= config_.start_hold_s;
}

StartMap::Worker& StartMap::map() {
  if (!map_) map_ = std::make_unique<Worker>(config_, T_base_lidar_, threaded_, spill_file_);
  return *map_;
}

void StartMap::note_scan(std::int64_t utime) {
  if (began_ == 0) began_ = utime;
  if (scan::seconds(began_, utime) >= kShows) is_shown_ = true;
}

bool StartMap::end_if_replaced(std::int64_t began, std::int64_t utime) {
  if (!map_ || (is_shown_ && scan::seconds(began, utime) < config_.settled_after())) return false;
  const bool was_shown = is_shown_;
  end();
  return was_shown;
}

void StartMap::end() {
  (void)hand_over();
}

std::unique_ptr<StartMap::Worker> StartMap::hand_over() {
  is_shown_ = false;
  is_over_ = true;
  began_ = 0;
  return std::exchange(map_, nullptr);
}

}  // namespace curbstone::mapper
