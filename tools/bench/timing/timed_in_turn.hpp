#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace curbstone::bench::timing {

/// Something to be timed.
struct Contender {
  std::string name;
  std::function<void()> work;
};

struct TurnOptions {
  int rounds = 5;         ///< how often each has its turn
  double min_time = 0.1;  ///< s, > 0, that a turn lasts at least; work is repeated until it has
  double slow = 20;       ///< s: whose turn takes longer than this has no second one
};

/// ms of one piece of work, the median of the turns.
struct TurnTimes {
  double wall_ms = 0;
  double cpu_ms = 0;  ///< of all threads: what remains comparable on a machine that has other things to do
};

/// Times contenders in turns (a, b, a, b, ...), so that what else the machine does in the meantime falls on all alike.
/// By Google Benchmark.
[[nodiscard]] std::vector<TurnTimes> time_in_turn(std::span<const Contender> contenders, const TurnOptions& options);

}  // namespace curbstone::bench::timing
