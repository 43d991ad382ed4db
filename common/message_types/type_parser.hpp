#pragma once

#include <string_view>
#include <vector>

#include "common/message_types/message_type.hpp"

namespace curbstone {

/// Parses the types that the text of a .lcm file defines (grammar: LCM's "type specification" page). Throws
/// std::runtime_error with the line at which the text is not a valid definition. Enumerations, which LCM has abandoned,
/// are not supported.
[[nodiscard]] std::vector<MessageType> parse_message_types(std::string_view text);

}  // namespace curbstone
