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
  void end(const std::string& id) { watched_.erase(id); }
  /// A status of the command has arrived. `faultless`: without a fault, and late enough to say so
  /// (SilenceTimer::kNamed).
  void on_status(const std::string& id, bool faultless, std::int64_t now);

  /// The deputy's own status, sent once a second, has arrived from the bus. After the first one, any time without it
  /// does not count as a command's silence: then the bus is silent, not the commands.
  void on_own_status(std::int64_t now) { own_status_at_ = now; }
  [[nodiscard]] bool is_bus_silent(std::int64_t now) const {
    return own_status_at_ != 0 && now - own_status_at_ > kOverdue;
  }

  /// Ids of commands that have been silent for too long, each once per life. Call it often: time in which it was not
  /// called, because the deputy itself had no CPU, does not count as silence.
  [[nodiscard]] std::vector<std::string> take_timed_out(std::int64_t now);

  /// Commands that have sent a status in this life and have been silent for longer than kOverdue, with the duration in
  /// s. They may be stopped, or get no CPU; they are left alone until take_timed_out() returns them. Empty while the
  /// bus is silent.
  static constexpr std::int64_t kOverdue = 2'500'000;  ///< us; statuses are sent at 1 Hz
  [[nodiscard]] std::vector<std::pair<std::string, double>> overdue(std::int64_t now) const;

  /// Whether it has sent a status in this life. Always true for a command that is not watched.
  [[nodiscard]] bool alive(const std::string& id) const;
  /// Whether it has sent a status without faults in this life. Always true for a command that is not watched.
  [[nodiscard]] bool ready(const std::string& id) const;

 private:
  struct Watched {
    std::int64_t patience = 0;  // us
    std::int64_t heard = 0;     // us, of the latest status, else of the start
    bool alive = false;
    bool ready = false;
    bool reported = false;
  };
  std::map<std::string, Watched> watched_;  // of commands that are watched
  std::int64_t checked_at_ = 0;             // us
  std::int64_t own_status_at_ = 0;          // us
  bool was_bus_silent_ = false;             // at the last call of take_timed_out()
};

}  // namespace curbstone::procman::deputy
