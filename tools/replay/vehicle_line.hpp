#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/replay/stage_line.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::replay {

/// The services of the vehicle as a line: the filter and the mapper, a voting worker, the semantic map. A thread for
/// each of the three or one for all: the same messages either way. ReplayOptions::tick_period is not used: in a replay
/// nobody waits for a tile, and those that are looked at rarely are worked on once.
class VehicleLine {
 public:
  /// Throws ConfigError, or std::runtime_error when the map cannot be written. So do the others, if it fails later.
  VehicleLine(const ReplayOptions& options, StageLine::Options line);

  /// A message of the drivers', of message time `now`, us.
  void deliver(std::int64_t now, std::string channel, std::vector<std::uint8_t> bytes);
  /// One that goes to the record alone.
  void note(std::string channel, std::vector<std::uint8_t> bytes);
  /// The drive is over: everything pending is finished, stage by stage.
  void finish() { line_->finish(); }

  /// Their nodes may be asked before the first message and after finish().
  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }

 private:
  void advance(std::int64_t now);

  std::vector<std::unique_ptr<StageGroup>> groups_;  // until the line has them
  std::vector<Stage> stages_;
  std::unique_ptr<StageLine> line_;
  std::int64_t last_beat_ = 0;  // us
  std::int64_t messages_ = 0;   // since then
};

}  // namespace curbstone::replay
