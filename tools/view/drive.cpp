#include "tools/view/drive.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "tools/recording/recorded_config.hpp"

namespace curbstone::view {
namespace {

constexpr std::int64_t kSearched = 20'000'000;  // us within which a log with a map has a message of it
constexpr std::int64_t kSeekStep = 1'000'000;   // us of the drive per call; the page is served in between
constexpr std::int64_t kTick = 50'000;          // us of message time

constexpr std::array<std::string_view, 11> kShown = {"SEMANTIC_TILE", "TILE_INDEX", "MAP_POSE",       "MAP_TRAJECTORY",
                                                     "CURBS",         "MARKINGS",   "LOCALIZED_POSE", "SERVICE_STATUS",
                                                     "LIDAR_POINTS",  "MAP_POINTS", "VOTED_POINTS"};
constexpr std::array<std::string_view, 3> kSensors = {"LIDAR_POINTS", "IMU", "WHEELS"};

template <class Names>
bool is_among(const Names& names, const std::string& channel) {
  return std::find(names.begin(), names.end(), channel) != names.end();
}

bool has_map(const std::vector<std::string>& logs) {
  LogFiles files(logs);
  std::optional<std::int64_t> begin;
  while (const auto event = files.next()) {
    if (!begin) begin = event->log_utime;
    if (event->channel == "SEMANTIC_TILE") return true;
    if (event->log_utime - *begin > kSearched) break;
  }
  return false;
}

replay::ReplayOptions options_for(const std::vector<std::string>& logs) {
  LogFiles head(logs);
  replay::ReplayOptions options;
  options.recorded = recording::recorded_config(head);
  options.assignments = {"semantic_map.map=", "mapper.folder=", "mapper.mode=map"};  // writes nothing
  options.tick_period = kTick;
  return options;
}

}  // namespace

VehicleConfig recorded_vehicle(const std::vector<std::string>& logs) {
  LogFiles head(logs);
  return recording::recorded_config(head).vehicle();
}

Drive::Drive(std::vector<std::string> logs, LocalBus& shown)
    : player_(logs, bus_, [this](const std::string& channel) {
        return vehicle_ ? is_among(kSensors, channel) : is_among(kShown, channel);
      }) {
  bus_.tap([&shown](const std::string& channel, const void* data, int size, std::int64_t) {
    if (is_among(kShown, channel)) shown.inject(channel, data, size);
  });
  if (!has_map(logs)) vehicle_.emplace(options_for(logs), bus_);
}

void Drive::advance(std::int64_t now) {
  if (goal_)
    seek();
  else
    player_.advance(now);
  work();
}

void Drive::seek() {
  const bool paused = player_.paused();
  const std::int64_t left = *goal_ - player_.position();
  if (left > 0) player_.step(std::min(left, kSeekStep));
  player_.set_paused(paused);
  if (left <= kSeekStep || player_.at_end()) goal_.reset();
}

void Drive::work() {
  bus_.dispatch();
  if (!vehicle_ || is_finished_) return;
  if (!player_.at_end()) return vehicle_->advance(player_.begin() + player_.position());
  if (vehicle_->settle()) return;  // the page is served in between
  vehicle_->finish();
  is_finished_ = true;
}

}  // namespace curbstone::view
