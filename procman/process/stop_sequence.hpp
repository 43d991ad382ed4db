#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "procman/process/supervisor.hpp"

namespace curbstone::procman::process {

/// Stops everything, stage by stage. A stage is stopped when all commands of the stage before have ended, so that a
/// pipeline drains from its source to its sink. The time is bounded: the supervisor kills what does not end in its
/// stop_time_allowed.
class StopSequence {
 public:
  StopSequence(Supervisor& supervisor, std::vector<std::vector<std::string>> stages);

  /// Does what is due at `now` (us). Returns true when all stages are done. Commands that are in no stage are stopped
  /// first.
  bool step(std::int64_t now);
  /// Ids of commands that did not end even after SIGKILL.
  [[nodiscard]] const std::vector<std::string>& abandoned() const { return abandoned_; }

 private:
  void begin_stage(std::int64_t now);

  Supervisor& supervisor_;
  std::vector<std::vector<std::string>> stages_;
  std::size_t stage_ = 0;
  bool begun_ = false;
  std::int64_t give_up_at_ = 0;
  std::vector<std::string> abandoned_;
};

}  // namespace curbstone::procman::process
