#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/config/vehicle.hpp"
#include "tools/play/player.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::view {

/// The vehicle that recorded a drive; the defaults if the log has no configuration.
[[nodiscard]] VehicleConfig recorded_vehicle(const std::vector<std::string>& logs);

/// Plays a recorded drive for the page. Recorded messages of the services are shown unchanged. A log with sensor data
/// only is processed by the services' nodes in this process. One thread.
class Drive {
 public:
  /// `shown`: gets the messages that the page can show; it must have no other subscribers. Throws std::runtime_error as
  /// LogFiles does, or ConfigError.
  Drive(std::vector<std::string> logs, LocalBus& shown);

  /// Plays what is due at `now`, us of any clock that does not jump; after go_to(), processes the log up to that
  /// position, one piece per call.
  void advance(std::int64_t now);
  void set_paused(bool paused) { player_.set_paused(paused); }
  void set_speed(double speed) { player_.set_speed(speed); }
  /// Continues at this position, us since the first record: all messages up to there are processed at once. Only
  /// forward: for an earlier position make another Drive.
  void go_to(std::int64_t us) { goal_ = us; }

  /// us since the first record.
  [[nodiscard]] std::int64_t position() const { return player_.position(); }
  [[nodiscard]] bool at_end() const { return player_.at_end(); }
  /// Whether the services' nodes compute the map in this process.
  [[nodiscard]] bool makes_map() const { return vehicle_.has_value(); }
  [[nodiscard]] const play::Player& player() const { return player_; }

 private:
  void work();
  void seek();

  LocalBus bus_;  // of the drive
  std::optional<replay::ReplayVehicle> vehicle_;
  play::Player player_;
  std::optional<std::int64_t> goal_;
  bool is_finished_ = false;
};

}  // namespace curbstone::view
