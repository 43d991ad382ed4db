#pragma once

#include <string_view>

#include "tools/play/player.hpp"

namespace curbstone::play {

/// Executes the commands of the keys. Returns false for q: quit.
///
///     space  pause, go on          .      a tenth of a second, then pause
///     right  10 s on               left   10 s back
///     + -    twice, half as fast   q      end
bool apply_keys(std::string_view keys, Player& player);

}  // namespace curbstone::play
