#pragma once

#include <termios.h>

#include <optional>
#include <string>

namespace curbstone::play {

/// Puts the terminal into unbuffered mode without echo until this object is destroyed. Without a terminal on the
/// standard input there are no keys.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  [[nodiscard]] bool is_there() const { return before_.has_value(); }
  /// The descriptor to wait on.
  [[nodiscard]] static int fd();
  /// The keys pressed since the last call, as bytes: an arrow is "\x1b[C". Does not wait.
  [[nodiscard]] std::string pressed() const;

 private:
  std::optional<termios> before_;
};

}  // namespace curbstone::play
