#pragma once

#include <string_view>

#include "tools/play/player.hpp"

namespace curbstone::play {

/// Does what the keys say. Returns false for q: the end.
///
///     space  pause, go on          .      a tenth of a second, then pause
///     right  10 s on               left   10 s back
///     + -    twice, half as fast   q      end
bool apply_keys(std::string_view keys, Player& player);

}  // namespace curbstone::play
