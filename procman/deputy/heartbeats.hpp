#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::procman::deputy {

/// Follows the SERVICE_STATUS of the commands that have a heartbeat. A command's status comes from the loop that does
/// its work, so one that hangs falls silent while its process lives on. Pure: time comes in, us of a clock that does
/// not jump.
class Heartbeats {
 public:
  static constexpr std::int64_t kFirst = 30'000'000;  ///< us from the start to the first status: a map may be loaded

  /// A life begins. `seconds` of silence are too many; 0: it is not watched.
  void begin(const std::string& id, double seconds, std::int64_t now);
  void end(const std::string& id) { lives_.erase(id); }
  /// Its status has come.
  void hear(const std::string& id, bool faultless, std::int64_t now);

  /// The deputy hears on the bus what it said itself, once a second. Once it did, the time in which it does not is held
  /// against nobody: the bus is silent, and not the commands.
  void hear_itself(std::int64_t now) { itself_ = now; }
  [[nodiscard]] bool is_deaf(std::int64_t now) const { return itself_ != 0 && now - itself_ > kQuiet; }

  /// Ids of commands that have been silent for too long, each once a life. To be called often: the time in which it was
  /// not called, because the deputy itself had no CPU, is not held against them.
  [[nodiscard]] std::vector<std::string> take_silent(std::int64_t now);

  /// Those that have spoken in this life and have been silent for longer than kQuiet, and for how long, s. They may be
  /// stopped, or get no CPU; they are left alone until their patience is over. None where the deputy is deaf.
  static constexpr std::int64_t kQuiet = 2'500'000;  ///< us; statuses come at 1 Hz
  [[nodiscard]] std::vector<std::pair<std::string, double>> quiet(std::int64_t now) const;

  /// Has it spoken in this life? A command that is not watched needs not.
  [[nodiscard]] bool alive(const std::string& id) const;
  /// Has it said in this life that it has no fault?
  [[nodiscard]] bool ready(const std::string& id) const;

 private:
  struct Life {
    std::int64_t patience = 0;  // us
    std::int64_t heard = 0;     // us, or when it began
    bool alive = false;
    bool ready = false;
    bool taken = false;
  };
  std::map<std::string, Life> lives_;  // of commands that are watched
  std::int64_t looked_ = 0;            // us
  std::int64_t itself_ = 0;            // us
  bool was_deaf_ = false;              // at the last look
};

}  // namespace curbstone::procman::deputy
