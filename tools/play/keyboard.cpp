#include "tools/play/keyboard.hpp"

#include <unistd.h>

namespace curbstone::play {

Keyboard::Keyboard() {
  termios settings{};
  if (tcgetattr(STDIN_FILENO, &settings) != 0) return;
  before_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

Keyboard::~Keyboard() {
  if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

int Keyboard::fd() {
  return STDIN_FILENO;
}

std::string Keyboard::pressed() const {
  char bytes[64];
  const ssize_t n = is_there() ? read(STDIN_FILENO, bytes, sizeof bytes) : 0;
  return n > 0 ? std::string(bytes, static_cast<std::size_t>(n)) : std::string();
}

}  // namespace curbstone::play
