#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/replay/stage_line.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::replay {

/// The services of the vehicle as a pipeline: filter and mapper, a voting worker, the semantic map. One thread for each
/// of the three or one for all, with the same messages either way. ReplayOptions::tick_period is not used: in a replay
/// no consumer waits for a tile, and with rarer ticks a tile that changes often is computed less often.
class VehicleLine {
 public:
  /// Throws ConfigError, or std::runtime_error if the map cannot be written. So do the other functions, if that fails
  /// later.
  VehicleLine(const ReplayOptions& options, StageLine::Options line);

  /// A driver's message. `now`: us, MessageOrder::time().
  void deliver(std::int64_t now, std::string channel, std::vector<std::uint8_t> bytes);
  /// A message for the record only.
  void note(std::string channel, std::vector<std::uint8_t> bytes);
  /// Ends the drive: time goes on until nothing is outstanding, then all pending work is finished, stage by stage.
  void finish();

  /// Messages that did not decode, or that a node failed on. After finish().
  [[nodiscard]] Counters bus_counters() const { return line_->bus_counters(); }
  /// Their nodes may be accessed before the first message and after finish(); without threads also in between.
  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }

 private:
  void advance(std::int64_t now);
  void settle();

  std::vector<std::unique_ptr<StageGroup>> groups_;  // moved into the line
  std::vector<Stage> stages_;
  std::unique_ptr<StageLine> line_;
  std::int64_t last_beat_ = 0;  // us
  std::int64_t messages_ = 0;   // since the last beat
};

}  // namespace curbstone::replay
