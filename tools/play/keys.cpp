#include "tools/play/keys.hpp"

namespace curbstone::play {

namespace {

constexpr std::int64_t kLeap = 10'000'000;  // us
constexpr std::int64_t kStep = 100'000;     // us

}  // namespace

bool apply_keys(std::string_view keys, Player& player) {
  while (!keys.empty()) {
    if (keys.starts_with("\x1b[C") || keys.starts_with("\x1b[D")) {
      player.seek(player.position() + (keys[2] == 'C' ? kLeap : -kLeap));
      keys.remove_prefix(3);
      continue;
    }
    switch (keys[0]) {
      case ' ':
        player.set_paused(!player.paused());
        break;
      case '.':
        player.step(kStep);
        break;
      case '+':
        player.set_speed(player.speed() * 2);
        break;
      case '-':
        player.set_speed(player.speed() / 2);
        break;
      case 'q':
        return false;
      default:
        break;
    }
    keys.remove_prefix(1);
  }
  return true;
}

}  // namespace curbstone::play
