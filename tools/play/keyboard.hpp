#pragma once

#include <termios.h>

#include <optional>
#include <string>

namespace curbstone::play {

/// A terminal whose keys come one by one and are not shown, until this object goes. Without a terminal on the standard
/// input there are no keys.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  [[nodiscard]] bool is_there() const { return before_.has_value(); }
  /// To wait for.
  [[nodiscard]] static int fd();
  /// What was pressed since, as bytes: an arrow is "\x1b[C". Does not wait.
  [[nodiscard]] std::string pressed() const;

 private:
  std::optional<termios> before_;
};

}  // namespace curbstone::play
