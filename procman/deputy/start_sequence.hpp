#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace curbstone::procman::deputy {

/// Starts everything. The first stage, the sources of the data, starts last, so that none of its messages is missed.
/// The other stages start together, beginning at the sink: without data they exchange nothing. The sources start when
/// all the others are up, or after kPatience: a command that does not come up must not delay them further. Pure: time
/// is an argument, us.
class StartSequence {
 public:
  static constexpr std::int64_t kPatience = 5'000'000;  ///< us

  struct Callbacks {
    std::function<void(const std::string& id)> start;
    /// Whether the command has sent a status, has ended, or sends no status at all.
    std::function<bool(const std::string& id)> is_up;
  };

  /// `stages` in the order of the data flow.
  StartSequence(std::vector<std::vector<std::string>> stages, Callbacks callbacks)
      : stages_(std::move(stages)), callbacks_(std::move(callbacks)) {}

  /// Does what is due at `now`. Returns true when all have been started.
  bool step(std::int64_t now);

 private:
  void start(const std::vector<std::string>& stage);

  std::vector<std::vector<std::string>> stages_;  // empty when all have been started
  Callbacks callbacks_;
  bool begun_ = false;
  std::int64_t since_ = 0;
};

}  // namespace curbstone::procman::deputy
