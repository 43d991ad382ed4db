#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/log/log_files.hpp"

namespace curbstone::play {

/// Publishes the messages of logs on a bus, at the pace of their records. The messages and their times are unchanged.
/// Where nothing was recorded for 10 s or more (between two sessions, or the host's clock was set forward) it goes on
/// at once. Where the records' times go back by as much, the clock was set back: it goes on at the same pace.
/// Independent of any clock: the time is an argument of advance(). One thread.
class Player {
 public:
  using Wanted = std::function<bool(const std::string& channel)>;

  /// Throws std::runtime_error as LogFiles does.
  Player(std::vector<std::string> logs, Publisher& bus, Wanted wanted);

  /// Publishes what is due at `now`, us of any clock that does not jump. After a late call at most 0.1 s is caught up.
  void advance(std::int64_t now);
  void set_paused(bool paused) { paused_ = paused; }
  [[nodiscard]] bool paused() const { return paused_; }
  /// Times real time: 0.01 to 100.
  void set_speed(double speed);
  [[nodiscard]] double speed() const { return speed_; }
  /// Publishes the next `us` of the log at once, and pauses.
  void step(std::int64_t us);
  /// Continues from there, us since the beginning, in either direction. The log is read up to there.
  void seek(std::int64_t us);

  /// us since the first record; at the end, the time of the last record. Steps back of the clock are left out.
  [[nodiscard]] std::int64_t position() const { return position_; }
  /// us since the Unix epoch, of the first record.
  [[nodiscard]] std::int64_t begin() const { return begin_; }
  [[nodiscard]] bool at_end() const { return !next_; }
  [[nodiscard]] std::int64_t published() const { return published_; }
  /// The share of the logs that was read, 0..1.
  [[nodiscard]] double progress() const { return files_->progress(); }
  [[nodiscard]] const LogFiles& files() const { return *files_; }

 private:
  void open();
  void read_next();
  void publish_until(std::int64_t position);

  std::vector<std::string> logs_;
  Publisher& bus_;
  Wanted wanted_;
  std::unique_ptr<LogFiles> files_;
  std::optional<LogEvent> next_;
  std::int64_t next_at_ = 0;   // us since the beginning
  std::int64_t set_back_ = 0;  // us, by which the clock of the records was set back so far
  std::int64_t begin_ = 0;
  std::int64_t position_ = 0;
  std::optional<std::int64_t> last_now_;
  double speed_ = 1;
  bool paused_ = false;
  std::int64_t published_ = 0;
};

}  // namespace curbstone::play
