#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/bus/node.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::replay {

/// Options of a replay.
struct ReplayOptions {
  std::string config_file;                  ///< the vehicle's file; empty: the recorded configuration, else defaults
  recording::RecordedConfig recorded = {};  ///< from the log
  std::vector<std::string> assignments;     ///< SECTION.KEY=VALUE, override the file
  std::string map_file;                     ///< semantic_map's store
  bool keep_earlier_drives = false;         ///< in files beside it, where the log holds more than one drive
  /// us of message time. It is 20 ms live. A replay can use a longer period, because no consumer waits for a tile and
  /// the resulting map does not depend on it.
  std::int64_t tick_period = 1'000'000;
};

/// A service of the vehicle as a node.
struct Stage {
  std::string name;
  std::string config;  ///< its section with all values, as YAML
  std::unique_ptr<Node> node;
};

/// Throws ConfigError if make_stages() would. Makes nothing.
void check_configuration(const ReplayOptions& options);
/// Makes ekf, mapper, one tensor-voting worker and semantic_map, not connected yet. `bus_of`: the publisher of a stage,
/// by its name. Throws ConfigError, or std::runtime_error if the map cannot be written.
[[nodiscard]] std::vector<Stage> make_stages(const ReplayOptions& options,
                                             const std::function<Publisher&(const std::string& name)>& bus_of);

/// Decides how long time goes on after the end of a drive.
class Settling {
 public:
  static constexpr std::int64_t kRound =
      4'000'000;  ///< us of message time between two looks: an answer to a request takes no longer

  /// Whether time has to go on beyond `now`, us: something is outstanding, and became less within the last kPatience.
  [[nodiscard]] bool goes_on(const std::vector<Stage>& stages, std::int64_t now);

 private:
  static constexpr std::int64_t kPatience = 5 * kRound;
  std::size_t least_ = std::numeric_limits<std::size_t>::max();
  std::int64_t since_ = 0;  // us
};

/// The services of the vehicle on one bus in one process and one thread: ekf, mapper, one tensor-voting worker,
/// semantic_map. The drivers are left out: their messages come from the log.
class ReplayVehicle {
 public:
  /// Throws ConfigError, or std::runtime_error if the map cannot be written.
  ReplayVehicle(const ReplayOptions& options, LocalBus& bus);
  ~ReplayVehicle();

  /// Advances message time to `now`: ticks every node each `tick_period`.
  void advance(std::int64_t now);
  /// After the last measurement: time goes on a little. Returns whether something is still outstanding. For a caller
  /// that has others to serve in between.
  bool settle();
  /// Ends the drive: time goes on until nothing is outstanding, then all pending work is finished, stage by stage.
  void finish();

  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }

 private:
  void tick(std::int64_t now);
  void end_drive();

  LocalBus& bus_;
  std::int64_t tick_period_;
  std::vector<Stage> stages_;
  std::int64_t last_tick_ = 0;
  std::optional<Settling> settling_;  // once the drive is over
};

}  // namespace curbstone::replay
