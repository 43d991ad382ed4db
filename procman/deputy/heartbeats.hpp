#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::procman::deputy {

/// Watches the SERVICE_STATUS of the commands that have a heartbeat. A command publishes its status from the loop that
/// does its work, so a command that hangs is silent while its process lives. Pure: time is an argument, us of a clock
/// that does not jump.
class Heartbeats {
 public:
  static constexpr std::int64_t kFirst = 30'000'000;  ///< us from start to first status: a map may have to be loaded

  /// A command was started. It counts as hung after `seconds` of silence; 0: it is not watched.
  void begin(const std::string& id, double seconds, std::int64_t now);
  void end(const std::string& id) { lives_.erase(id); }
  /// A status of the command has arrived.
  void hear(const std::string& id, bool faultless, std::int64_t now);

  /// The deputy's own status, sent once a second, has arrived from the bus. After the first one, any time without it
  /// does not count as a command's silence: then the bus is silent, not the commands.
  void hear_itself(std::int64_t now) { itself_ = now; }
  [[nodiscard]] bool is_deaf(std::int64_t now) const { return itself_ != 0 && now - itself_ > kQuiet; }

  /// Ids of commands that have been silent for too long, each once per life. Call it often: time in which it was not
  /// called, because the deputy itself had no CPU, does not count as silence.
  [[nodiscard]] std::vector<std::string> take_silent(std::int64_t now);

  /// Commands that have sent a status in this life and have been silent for longer than kQuiet, with the duration in s.
  /// They may be stopped, or get no CPU; they are left alone until take_silent() returns them. Empty while the deputy
  /// is deaf.
  static constexpr std::int64_t kQuiet = 2'500'000;  ///< us; statuses are sent at 1 Hz
  [[nodiscard]] std::vector<std::pair<std::string, double>> quiet(std::int64_t now) const;

  /// Whether it has sent a status in this life. Always true for a command that is not watched.
  [[nodiscard]] bool alive(const std::string& id) const;
  /// Whether it has sent a status without faults in this life. Always true for a command that is not watched.
  [[nodiscard]] bool ready(const std::string& id) const;

 private:
  struct Life {
    std::int64_t patience = 0;  // us
    std::int64_t heard = 0;     // us, of the latest status, else of the start
    bool alive = false;
    bool ready = false;
    bool taken = false;
  };
  std::map<std::string, Life> lives_;  // of commands that are watched
  std::int64_t looked_ = 0;            // us
  std::int64_t itself_ = 0;            // us
  bool was_deaf_ = false;              // at the last call of take_silent()
};

}  // namespace curbstone::procman::deputy
