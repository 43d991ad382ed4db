#pragma once

#include <string_view>

namespace curbstone {

/// Whether a counter of SERVICE_STATUS counts what a follower of tiles leaves out because it has it, or will hear it
/// again: nothing was lost.
[[nodiscard]] inline bool is_harmless(std::string_view counter) {
  return counter == "dropped.known" || counter == "dropped.superseded" || counter == "dropped.other_epoch";
}

}  // namespace curbstone
