#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace curbstone::procman::output {

/// Lines for a person, who may stop reading: Ctrl-S in a terminal, a pager, a connection that stalls. A thread of its
/// own writes them, because the write then blocks; whoever prints never waits. Lines beyond `most` bytes are dropped,
/// and the next one that is written is preceded by their number.
class Console {
 public:
  static constexpr std::size_t kMaxWaiting = 1 << 20;  ///< bytes that wait

  explicit Console(int fd, std::size_t most = kMaxWaiting);
  /// Waits a second at most for what is not written yet; the thread is left behind if it is blocked still.
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void print(std::string_view line);
  [[nodiscard]] std::int64_t dropped() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace curbstone::procman::output
