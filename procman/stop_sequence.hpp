#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "procman/supervisor.hpp"

namespace curbstone::procman {

/// Stops everything, one stage after the other: a stage is stopped when all of the one before have ended, so that a
/// pipeline drains from its source to its sink. Bounded: the supervisor kills what does not end in its time.
class StopSequence {
 public:
  StopSequence(Supervisor& supervisor, std::vector<std::vector<std::string>> stages);

  /// Does what is due at `now` (us). True when it is over. Commands that are in no stage are stopped first.
  bool step(std::int64_t now);
  /// Ids that would not even die.
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

}  // namespace curbstone::procman
