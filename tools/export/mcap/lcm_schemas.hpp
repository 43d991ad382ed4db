#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/mcap/mcap_writer.hpp"

namespace curbstone::map_export::mcap {

/// What our LCM messages are, for files that hold them: encoding "lcm", data is the text of the type's .lcm file and,
/// behind it, of those that it is made of. (MCAP's registry has no name for LCM.)
class LcmSchemas {
 public:
  LcmSchemas();
  /// By the eight bytes with which a message begins. Nothing: it is none of our types.
  [[nodiscard]] std::optional<McapSchema> of(const void* message, std::size_t size) const;

 private:
  std::map<std::string, std::string> texts_;  // by type
};

}  // namespace curbstone::map_export::mcap
