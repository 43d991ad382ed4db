#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <procman_lcm/output_t.hpp>
#include <string>
#include <string_view>

#include "procman/output/utf8.hpp"

namespace curbstone::procman::output {

/// Queue of text to be sent as PM_OUTPUT, with bounded messages and a bounded size. Dropped text is mentioned in the
/// output. Pure; the caller sets the rate.
class OutputQueue {
 public:
  static constexpr std::size_t kMaxMessage = 40'000;          ///< bytes of text in a message: below 48 kB in total
  static constexpr std::size_t kMaxQueued = 4 * 1024 * 1024;  ///< bytes; beyond that, new text is dropped and counted

  explicit OutputQueue(std::string deputy_id) : deputy_id_(std::move(deputy_id)) {}

  /// With an empty `command_id` the text is the deputy's own.
  void add(const std::string& command_id, std::string_view bytes);

  /// The next message: oldest text first, consecutive text of a command in one message. Nothing if the queue is empty.
  [[nodiscard]] std::optional<procman_lcm::output_t> take(std::int64_t utime);

  [[nodiscard]] bool empty() const { return chunks_.empty(); }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }  ///< bytes

 private:
  struct Chunk {
    std::string command_id;
    std::string text;
  };
  std::string deputy_id_;
  std::map<std::string, Utf8Stream> streams_;
  std::deque<Chunk> chunks_;
  std::size_t queued_ = 0;
  std::int64_t dropped_ = 0;
  std::int64_t dropped_unreported_ = 0;
};

}  // namespace curbstone::procman::output
