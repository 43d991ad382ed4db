#pragma once

#include <string_view>

namespace curbstone {

/// Whether a counter of SERVICE_STATUS counts messages that a tile follower ignores because it already has their
/// content or will receive it again: nothing was lost.
[[nodiscard]] inline bool is_harmless(std::string_view counter) {
  return counter == "dropped.known" || counter == "dropped.superseded" || counter == "dropped.other_epoch";
}

}  // namespace curbstone
