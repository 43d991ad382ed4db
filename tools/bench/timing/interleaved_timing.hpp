#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace curbstone::bench::timing {

/// A piece of work to be timed.
struct Contender {
  std::string name;
  std::function<void()> work;
};

struct TurnOptions {
  int rounds = 5;         ///< turns per contender
  double min_time = 0.1;  ///< s, > 0, minimum duration of a turn; the work is repeated to fill it
  double slow = 20;       ///< s: a contender whose turn takes longer gets no second one
};

/// ms per execution of the work, median of the turns.
struct TurnTimes {
  double wall_ms = 0;
  double cpu_ms = 0;  ///< of all threads: comparable on a machine under other load
};

/// Times contenders in turn (a, b, a, b, ...), so that other load on the machine affects all alike. Uses Google
/// Benchmark.
[[nodiscard]] std::vector<TurnTimes> time_in_turn(std::span<const Contender> contenders, const TurnOptions& options);

}  // namespace curbstone::bench::timing
