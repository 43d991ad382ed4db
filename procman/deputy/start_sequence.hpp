#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace curbstone::procman::deputy {

/// Starts everything, one stage after the other: from the sink to the source, so that nothing of what a stage says is
/// missed. A stage begins when all commands of the stage before are up, or kPatience later: one that does not come up
/// must not keep the others down. Pure: time comes in, us.
class StartSequence {
 public:
  static constexpr std::int64_t kPatience = 5'000'000;  ///< us

  struct Hands {
    std::function<void(const std::string& id)> start;
    /// Has it said something, or ended, or can it say nothing?
    std::function<bool(const std::string& id)> is_up;
  };

  /// `stages` in the order of the data: the last one is started first.
  StartSequence(std::vector<std::vector<std::string>> stages, Hands hands)
      : stages_(std::move(stages)), hands_(std::move(hands)) {}

  /// Does what is due at `now`. True when all have been started.
  bool step(std::int64_t now);

 private:
  std::vector<std::vector<std::string>> stages_;  // the last one is next, or being started
  Hands hands_;
  bool begun_ = false;
  std::int64_t since_ = 0;
};

}  // namespace curbstone::procman::deputy
