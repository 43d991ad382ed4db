#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "tools/play/player.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::view {

/// A recorded drive, played for the page. What the services said then is shown as they said it. A log of sensors alone
/// is given to the services' nodes, here and now. One thread.
class Drive {
 public:
  /// `shown`: gets what the page can show; nobody else hears it. Throws std::runtime_error as LogFiles does, or
  /// ConfigError.
  Drive(std::vector<std::string> logs, LocalBus& shown);

  /// Plays what is due `now`, us of any clock that does not jump; or the way to the place of go_to(), a piece at once.
  void advance(std::int64_t now);
  void set_paused(bool paused) { player_.set_paused(paused); }
  void set_speed(double speed) { player_.set_speed(speed); }
  /// Goes on to this place, us since the first record: all that was said until there is taken in at once. Only forward:
  /// for an earlier place make another Drive.
  void go_to(std::int64_t us) { goal_ = us; }

  /// us since the first record.
  [[nodiscard]] std::int64_t position() const { return player_.position(); }
  [[nodiscard]] bool at_end() const { return player_.at_end(); }
  /// Whether the services' nodes make the map anew.
  [[nodiscard]] bool makes_map() const { return vehicle_.has_value(); }
  [[nodiscard]] const play::Player& player() const { return player_; }

 private:
  void work();
  void leap();

  LocalBus bus_;  // of the drive
  std::optional<replay::ReplayVehicle> vehicle_;
  play::Player player_;
  std::optional<std::int64_t> goal_;
  bool is_finished_ = false;
};

}  // namespace curbstone::view
