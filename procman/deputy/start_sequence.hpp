#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace curbstone::procman::deputy {

/// Starts everything: the first stage, the sources of the data, last, so that nothing of what they say is missed. The
/// others begin together, from the sink on: until a source speaks they have nothing to say to each other. The sources
/// begin when all the others are up, or kPatience later: one that does not come up must not keep them down. Pure: time
/// comes in, us.
class StartSequence {
 public:
  static constexpr std::int64_t kPatience = 5'000'000;  ///< us

  struct Hands {
    std::function<void(const std::string& id)> start;
    /// Has it said something, or ended, or can it say nothing?
    std::function<bool(const std::string& id)> is_up;
  };

  /// `stages` in the order of the data.
  StartSequence(std::vector<std::vector<std::string>> stages, Hands hands)
      : stages_(std::move(stages)), hands_(std::move(hands)) {}

  /// Does what is due at `now`. True when all have been started.
  bool step(std::int64_t now);

 private:
  void start(const std::vector<std::string>& stage);

  std::vector<std::vector<std::string>> stages_;  // none any more when all have been started
  Hands hands_;
  bool begun_ = false;
  std::int64_t since_ = 0;
};

}  // namespace curbstone::procman::deputy
